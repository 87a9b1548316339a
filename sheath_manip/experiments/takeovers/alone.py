"""The policy alone, on scene after scene: those in which it fails are what gates are tried on."""

import json
from dataclasses import asdict, dataclass
from typing import Self

from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.recorder import Recorder
from sheath_manip.dataset.space import Space
from sheath_manip.exceptions import StoreError
from sheath_manip.experiments.takeovers.stretch import Stretch
from sheath_manip.experiments.takeovers.watched import Watched
from sheath_manip.files.json_files import write_json
from sheath_manip.learning.checkpoint import digest
from sheath_manip.learning.drivers import PolicyAlone
from sheath_manip.protocols import Report
from sheath_manip.rollout.request import EpisodeRequest
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.seeding import generator, scene_seed
from sheath_manip.types import Episode, EpisodeInfo, Outcome, Purpose, TaskSpec

LOT = "takeovers-{}"
"""the method under which the policy's episodes alone are stored"""


@dataclass(frozen=True)
class Scene:
    """A scene that gates are tried on."""

    index: int
    """of the episode, in its lot"""
    failing: bool
    """whether the policy alone does not succeed there"""
    first_step: int = 0
    """of the episode, with which it begins"""


@dataclass(frozen=True)
class Alone:
    """What the policy did alone on the first scenes of a lot."""

    episodes: int
    """or stretches of episodes, where a scene is one"""
    failing: int
    """of these, those that did not succeed"""
    stuck: int
    """of these, those whose time was over"""
    scenes: tuple[Scene, ...]
    """that gates are tried on"""

    def weight(self, failing: bool) -> float:
        """Return how many of the episodes one scene of that kind stands for."""
        kept = sum(scene.failing is failing for scene in self.scenes)
        count = self.failing if failing else self.episodes - self.failing
        return count / kept if kept else 0.0

    @classmethod
    def read(cls, at: Watched, lot: str) -> Self:
        """Read what was found; raises StoreError where that is no such thing."""
        path = at.alone_path(lot)
        try:
            content = json.loads(path.read_text())
            scenes = tuple(Scene(**scene) for scene in content["scenes"])
            return cls(**{**content, "scenes": scenes})
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise StoreError(f"{path} is broken ({error}); remove it to have it found again") from (
                error
            )


def try_alone(at: Watched, lot: str, report: Report) -> None:
    """Let the policy drive until enough scenes failed, or the most were tried; keep the chosen."""
    quota = at.plan.quota(lot)
    spec = at.spec()
    driver = PolicyAlone(at.checkpoint_path, digest(at.checkpoint_path))
    recorder = Recorder(at.store)
    recorder.space = Space.of(spec)
    kept: list[Scene] = []
    episodes = failing = stuck = 0
    with SerialExecutor() as executor:
        requests = (
            EpisodeRequest(at.task, scene_info(at, spec, lot, index), driver)
            for index in range(quota.most)
        )
        for index, episode in enumerate(executor.map(requests)):
            report(f"{at.study.name} {at.name} alone")
            found = scenes_of(at, spec, lot, index, episode)
            episodes += found.episodes
            failing += found.failing
            stuck += found.stuck
            for scene in found.scenes:
                alike = sum(each.failing is scene.failing for each in kept)
                if alike < (quota.failing if scene.failing else quota.succeeding):
                    kept.append(scene)
                    if not at.store.has(episode.info):
                        recorder.on_end(episode)
            if sum(scene.failing for scene in kept) == quota.failing:
                break
    write_json(at.alone_path(lot), asdict(Alone(episodes, failing, stuck, tuple(kept))))


def scenes_of(at: Watched, spec: TaskSpec, lot: str, index: int, episode: Episode) -> Alone:
    """Return what one episode counts, and the scenes in it.

    Of a task whose scenes are stretches, that is one that ends some time after the failure, drawn
    from a quarter to three quarters of its length, and the one before it.
    """
    most = at.stretch_steps(spec)
    fails, stuck = (episode.outcome is each for each in (Outcome.FAILURE, Outcome.TIME_LIMIT))
    if most is None:
        return Alone(1, int(fails or stuck), int(stuck), (Scene(index, fails or stuck),))
    count = -(-len(episode) // most)
    if not fails:
        return Alone(count, 0, 0, (Scene(index, False),))
    before = generator("takeovers", "stretch", at.name, lot, index).integers(
        most // 4, 3 * most // 4 + 1
    )
    first = max(0, len(episode) - int(before))
    scenes = [Scene(index, True, first)]
    if first >= most:
        scenes.append(Scene(index, False, first - most))
    return Alone(count, 1, 0, tuple(scenes))


def alone_episode(at: Watched, spec: TaskSpec, lot: str, index: int) -> Episode:
    """Read what the policy alone did in an episode that was kept."""
    return at.store.read(episode_name(scene_info(at, spec, lot, index)))


def alone_on(at: Watched, spec: TaskSpec, lot: str, scene: Scene) -> Stretch:
    """Read what the policy alone did on a scene that was kept."""
    episode = alone_episode(at, spec, lot, scene.index)
    return Stretch.of(episode, scene.first_step, at.stretch_steps(spec))


def scene_info(at: Watched, spec: TaskSpec, lot: str, index: int) -> EpisodeInfo:
    """Return the info of an episode on a scene: all policies meet the same scenes."""
    return EpisodeInfo.of(
        spec,
        variant=at.learning.schedule.variant,
        seed=scene_seed(Purpose.EVALUATION, LOT.format(lot), index),
        purpose=Purpose.EVALUATION,
        method=LOT.format(lot),
        round=at.rounds,
        index=index,
        run_seed=at.seed,
        checkpoint=digest(at.checkpoint_path),
    )
