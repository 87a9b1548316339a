"""The platformer's own figure, and the frames of its films."""

from math import floor
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

from sheath_manip.dataset.recorder import Recorder
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.experiments.figures.intervention import NothingToShowError
from sheath_manip.experiments.figures.replayed import pictures_of
from sheath_manip.gates import AlwaysExpert
from sheath_manip.protocols import Expert
from sheath_manip.rollout.loop import rollout
from sheath_manip.tasks.platformer.entry import PLATFORMER, make_stage_of
from sheath_manip.tasks.platformer.expert import PlatformerExpert
from sheath_manip.tasks.platformer.stage import LEAD_TILES
from sheath_manip.tasks.platformer.study.figures import before_a_gap, scene
from sheath_manip.tasks.platformer.task import PlatformerTask
from sheath_manip.types import (
    Actor,
    EpisodeInfo,
    GateDecision,
    Observation,
    Observations,
    Proposal,
    Purpose,
    Reason,
)


def players_column(picture: np.ndarray) -> float:
    """0 at the left edge, 1 at the right one."""
    red, green, blue = np.moveaxis(picture.astype(int), -1, 0)
    seen = (red > 120) & (green < 60) & (blue < 60)
    assert seen.any()
    return float(np.nonzero(seen)[1].mean()) / picture.shape[1]


def test_a_demonstration_is_shown_in_the_middle_and_its_frames_from_its_states(tmp_path):
    store, path = EpisodeStore.create(tmp_path / "store"), tmp_path / "scene.png"
    environment = make_stage_of("run", 3)
    checkpoint = SimpleNamespace(run_seed=3)
    with pytest.raises(NothingToShowError, match="no demonstrations of seed 3"):
        scene(store, checkpoint, environment, path)  # type: ignore[arg-type]
    info = EpisodeInfo(
        "platformer", 5, Purpose.DEMONSTRATION, 24.0, "expert", run_seed=3, variant="stage"
    )
    episode = rollout(
        environment,
        info,
        AlwaysExpert(),
        rng=np.random.default_rng(0),
        expert=PlatformerExpert(environment),
        listeners=[Recorder(store)],
    )
    scene(store, checkpoint, environment, path)  # type: ignore[arg-type]
    environment.close()
    with Image.open(path) as image:
        assert image.width == 1600
        assert players_column(np.asarray(image.convert("RGB"))[:600]) == pytest.approx(1 / 3, 0.1)
    frames = pictures_of(PLATFORMER, "stage")(episode, [10, 60])
    assert [frame.shape for frame in frames] == [(360, 720, 3)] * 2
    assert not np.array_equal(frames[0], frames[1])
    for frame in frames:
        assert players_column(frame) == pytest.approx(1 / 3, 0.1)


class Copycat:
    """A policy that does what an expert would do."""

    def __init__(self, expert: Expert) -> None:
        self.expert = expert

    def reset(self, rng: np.random.Generator) -> None:
        del rng

    def propose(self, observations: Observations) -> Proposal:
        observation = Observation({}, observations.features[0], 0.0)
        return Proposal(self.expert.act(observation)[None])


class AtTheFirst:
    """A gate that gives the expert one second: from where `column` is 2 tiles ahead."""

    def __init__(self, environment, column: int) -> None:
        self.environment, self.column, self.left = environment, column, 24

    def reset(self, rng) -> None:
        del rng
        self.left = 24

    def decide(self, observation, proposal) -> GateDecision:
        del observation, proposal
        near = floor(self.environment.task.moment.x) + LEAD_TILES >= self.column - 2
        acts = near and self.left > 0
        self.left -= acts
        return GateDecision(Actor.EXPERT if acts else Actor.POLICY, acts, Reason.OUTSIDE, 0.0, 1.0)


def test_a_film_of_a_takeover_before_a_gap_wants_a_gap(tmp_path):
    environment = make_stage_of("run", 3)
    environment.reset(5)
    task = environment.task
    assert isinstance(task, PlatformerTask)
    heights = task.stage.heights
    gap = int(np.flatnonzero(heights == 0)[0])
    wall = int(np.flatnonzero(np.diff(heights[LEAD_TILES:]) > 0)[0]) + LEAD_TILES + 1
    path, checkpoint = tmp_path / "film.gif", SimpleNamespace(run_seed=3)
    for column, shown in ((wall, False), (gap, True)):
        expert = PlatformerExpert(environment)
        store = EpisodeStore.create(tmp_path / str(column))
        rollout(
            environment,
            EpisodeInfo("platformer", 5, Purpose.LEARNING, 24.0, "sheath", 1, run_seed=3),
            AtTheFirst(environment, column),
            rng=np.random.default_rng(0),
            policy=Copycat(expert),
            expert=expert,
            listeners=[Recorder(store)],
        )
        if shown:
            before_a_gap(store, checkpoint, environment, path)  # type: ignore[arg-type]
        else:
            with pytest.raises(NothingToShowError):
                before_a_gap(store, checkpoint, environment, path)  # type: ignore[arg-type]
    environment.close()
    with Image.open(path) as image:
        assert image.n_frames > 30  # pyright: ignore[reportAttributeAccessIssue]
