import numpy as np
import pytest
from PIL import Image

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.experiments.figures import NothingToShowError
from sheath_manip.gates.config import GateConfig
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.signals.support import SupportSignal
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.driving.study import figures
from sheath_manip.tasks.driving.study.figures import draw_support, gate_map, pose_scores, support
from sheath_manip.tasks.driving.task import DrivingTask
from sheath_manip.tasks.driving.track import Track
from sheath_manip.types import Observations, Proposal


def grass(observations: Observations, proposal: Proposal) -> np.ndarray:
    del proposal
    middle = observations.images["overhead"][:, 55:70, 55:70].astype(float)
    return (middle[..., 1] - middle[..., 2]).mean((1, 2))[:, None]


class Idle:
    """A policy that looks at nothing."""

    def predict(self, observations: Observations) -> Proposal:
        return Proposal(np.zeros((len(observations), 1), np.float32))

    def surrogate_losses(self, proposal: Proposal, labels: np.ndarray) -> np.ndarray:
        del labels
        return np.zeros(len(proposal.actions), np.float32)


class GreenEmbedding:
    """One number a picture: how much of what lies under the car is grass."""

    uses_displaced = False

    def attach(self, policy):
        del policy
        return (grass,)

    def transform(self, seen):
        return seen.readings[grass]


class OnTheRoad:
    """Positive on tarmac, which is as blue as green."""

    def decision_function(self, X):
        return 15.0 - X[:, 0]


@pytest.fixture(scope="module")
def environment():
    environment = ComposerEnvironment(DrivingTask())
    yield environment
    environment.close()


@pytest.fixture
def checkpoint() -> Checkpoint:
    signal = SupportSignal(GreenEmbedding(), OnTheRoad())  # type: ignore[arg-type]
    policy = Idle()
    fitted = FittedGate(GateConfig(), policy, signal, threshold=0.0)  # type: ignore[arg-type]
    return Checkpoint("driving", "none", policy, fitted, "sheath", 2)  # type: ignore[arg-type]


def test_the_support_is_drawn_around_the_track(tmp_path):
    track = Track()
    rng = np.random.default_rng(0)
    poses = track.pose(rng.uniform(0, track.lap_length, 600), rng.normal(0, 1, 600))
    path = tmp_path / "support.png"
    draw_support(poses[:, :2], track, path)
    with Image.open(path) as image:
        assert image.width == 1600
        pixels = np.asarray(image.convert("RGB")).astype(int)
    yellow = (pixels[..., 0] > 180) & (pixels[..., 2] < 130)
    assert all(quarter.mean() > 0.01 for quarter in np.array_split(yellow, 4, 1))
    assert path.stat().st_size < 300_000


def test_the_support_wants_demonstrations(environment, checkpoint, tmp_path):
    store = EpisodeStore.create(tmp_path / "store")
    with pytest.raises(NothingToShowError, match="no demonstrations of seed 0"):
        support(store, checkpoint, environment, tmp_path / "support.png")


def test_the_gates_map_tells_road_from_grass_and_is_repeatable(environment, checkpoint):
    track = environment.task.track
    s = np.linspace(0, track.lap_length, 12, endpoint=False)
    on, off = track.pose(s, np.full(12, 2.0)), track.pose(s, np.full(12, -8.0))
    poses = np.concatenate([on, off])
    scores = pose_scores(checkpoint, environment, poses)
    assert (scores[:12] > 0).all()
    assert (scores[12:] < 0).all()
    # The traffic, which another seed laid elsewhere, is out of sight.
    environment.reset(7)
    np.testing.assert_array_equal(pose_scores(checkpoint, environment, poses), scores)


def test_the_gates_map_is_drawn(environment, checkpoint, tmp_path, monkeypatch):
    monkeypatch.setattr(figures, "ALONG_STEPS", 24)
    monkeypatch.setattr(figures, "ACROSS_STEPS", 7)
    store = EpisodeStore.create(tmp_path / "store")
    path = tmp_path / "gate_map.png"
    gate_map(store, checkpoint.with_threshold(1.0), environment, path)
    with Image.open(path) as image:
        pixels = np.asarray(image.convert("RGB")).astype(int)
    assert ((pixels[..., 0] > 200) & (pixels[..., 2] < 100)).any()
    assert ((pixels[..., 2] > 150) & (pixels[..., 0] < 120)).any()
