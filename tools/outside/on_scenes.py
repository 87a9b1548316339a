"""A policy of demonstrations alone on fresh scenes: by itself, under its gate, and at random."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.experiments.study import Study
from sheath_manip.experiments.takeovers.schedules import SCHEDULES, Gated
from sheath_manip.experiments.takeovers.trial import Trial, read_trials, write_trials
from sheath_manip.gates import AlwaysPolicy
from sheath_manip.gates.scheduled import ScheduledTakeovers
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.run import LearningRun
from sheath_manip.learning.start import SharedStart
from sheath_manip.protocols import Gate
from sheath_manip.rollout.loop import rollout
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.seeding import generator, scene_seed
from sheath_manip.types import Episode, EpisodeInfo, Outcome, Purpose

ALONE, GATED = "alone", "gated"
AT_RANDOM = ("random-steps", "random-blocks")
"""as many of the steps as under the gate, and turns as many and as long as under it"""
WAYS = (ALONE, GATED, *AT_RANDOM)
SCENES = "gated"
"""key of the scenes, which no round of learning has"""


@dataclass(frozen=True)
class OnScenes:
    """One training seed: its policy, its gate, and the scenes that all ways meet."""

    study: Study
    plan: LearningPlan
    seed: int
    runs: Path
    say: Callable[[str], None] = print

    @property
    def folder(self) -> Path:
        """Of what came of it."""
        return self.runs / f"seed-{self.seed}"

    def trials(self) -> dict[str, list[Trial]]:
        """Return what came of each way, in the order of the scenes; what is there is read."""
        missing = [way for way in WAYS if not self._path(way).exists()]
        if missing:
            self._try(missing)
        return {way: read_trials(self._path(way))[way] for way in WAYS}

    def _try(self, ways: Sequence[str]) -> None:
        store = EpisodeStore.create(self.runs / "store")
        with SerialExecutor() as executor:
            start = LearningRun(
                self.study.task, self.plan, self.seed, self.runs, store, executor, failures=True
            ).start()
        self.say(f"seed {self.seed}: policy and gate are fitted")
        for way in ways:
            trials = self._of(way, start)
            write_trials(self._path(way), {way: trials})
            done = sum(not trial.fails for trial in trials)
            self.say(f"seed {self.seed}: {way} succeeds in {done} of {len(trials)}")

    def _of(self, way: str, start: SharedStart) -> list[Trial]:
        known = {each: read_trials(self._path(each))[each] for each in WAYS[: WAYS.index(way)]}
        trials, task = [], self.study.task
        with closing(task.make_for_run(self.plan.schedule.variant, self.seed)) as environment:
            expert = task.make_expert(environment)
            for index in range(self.plan.comparison.final_episodes):
                info = EpisodeInfo.of(
                    environment.spec,
                    variant=self.plan.schedule.variant,
                    seed=scene_seed(Purpose.EVALUATION, SCENES, self.seed, index),
                    purpose=Purpose.EVALUATION,
                    method=way,
                    index=index,
                    run_seed=self.seed,
                )
                episode = rollout(
                    environment,
                    info,
                    self._gate(way, start, known, index),
                    rng=generator(SCENES, self.seed, index),
                    policy=start.checkpoint.policy,
                    expert=expert,
                )
                trials.append(_trial(episode, known, index))
        return trials

    def _gate(
        self, way: str, start: SharedStart, known: Mapping[str, Sequence[Trial]], index: int
    ) -> Gate:
        if way == ALONE:
            return AlwaysPolicy()
        if way == GATED:
            return start.checkpoint.gate()
        # Equal in all scenes together, not in those alone in which the policy fails.
        gated = [replace(trial, failing=False) for trial in known[GATED]]
        draws = generator(SCENES, way, self.seed, index)
        alone_steps = [trial.steps for trial in known[ALONE]]
        return ScheduledTakeovers(SCHEDULES[way](Gated(gated, alone_steps), index, draws))

    def _path(self, way: str) -> Path:
        return self.folder / f"{way}.json"


def _trial(episode: Episode, known: Mapping[str, Sequence[Trial]], index: int) -> Trial:
    alone = known[ALONE][index].outcome if ALONE in known else episode.outcome
    return Trial.of(episode, alone is not Outcome.SUCCESS)
