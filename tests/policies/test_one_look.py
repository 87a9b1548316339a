"""Each image passes each network once: in a control step, and in the fit of a signal."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from sheath_manip.gates import SupportGate
from sheath_manip.gates.config import GateConfig
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.policies.looking import look, look_to_fit, seen_in
from sheath_manip.policies.network import ConvNetwork
from sheath_manip.policies.spatial_network import SpatialNetwork
from sheath_manip.policies.tool_view import ToolView
from sheath_manip.protocols import Signal, TrainablePolicy
from sheath_manip.rollout.loop import rollout
from sheath_manip.signals import SignalChoice, make_signal
from sheath_manip.types import (
    Action,
    Actor,
    EpisodeInfo,
    Observation,
    Outcome,
    Purpose,
    TaskSpec,
    Transition,
)
from sheath_manip.types.samples import Samples
from tests import blobs, line, reach


@dataclass(frozen=True)
class Looking:
    """A fitted policy, a signal by choice, and what they are to look at."""

    spec: TaskSpec
    policy: TrainablePolicy
    choice: SignalChoice
    training: Samples
    held_out: Samples
    networks: int
    """that see an image: the policy's own, and others that an embedding looks through"""


def blobs_by(signal: str, embedding: str, precedent: str, networks: int = 1) -> Looking:
    choice = SignalChoice(signal, embedding, "one-class-svm", precedent)
    policy = blobs.fitted_policy("cnn")
    return Looking(blobs.SPEC, policy, choice, blobs.training(), blobs.held_out(), networks)


def reach_by(embedding: str, precedent: str) -> Looking:
    choice = SignalChoice("near-joined", embedding, "one-class-svm", precedent)
    policy = reach.fitted_policy()
    return Looking(reach.SPEC, policy, choice, reach.training(), reach.held_out(), 1)


def line_by(embedding: str, precedent: str) -> Looking:
    choice = SignalChoice("near-joined", embedding, "one-class-svm", precedent)
    policy = line.fitted_policy()
    return Looking(line.SPEC, policy, choice, line.training(), line.held_out(), 1)


CASES = {
    "driving": lambda: blobs_by("joined", "convolutions-and-pixels", "foveal-contrasts"),
    "trusted": lambda: blobs_by("trust-joined", "two-scale-convolutions", "pooled-convolutions"),
    "another network": lambda: blobs_by("joined", "random-convolutions", "penultimate", 2),
    "reach": lambda: reach_by("wrist-convolutions", "camera-convolutions"),
    "line": lambda: line_by("tool-convolutions-whitened", "tool-points"),
}


@pytest.fixture(params=CASES)
def looking(request) -> Looking:
    return CASES[request.param]()


class Passes:
    """How often each image passed each network, and each tool's view."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.networks: Counter = Counter()
        self.views: Counter = Counter()
        monkeypatch.setattr(ConvNetwork, "activations", self._counted(ConvNetwork.activations))
        monkeypatch.setattr(
            SpatialNetwork, "activations", self._counted(SpatialNetwork.activations)
        )
        warped = ToolView.images

        def images(view: ToolView, images: NDArray[np.uint8], features: NDArray):
            self.views.update((id(view), image.tobytes()) for image in images)
            return warped(view, images, features)

        monkeypatch.setattr(ToolView, "images", images)

    def _counted(self, activations):
        def counted(network, images, *options):
            cameras = images if isinstance(images, Mapping) else {"": images}
            for name, each in cameras.items():
                self.networks.update((id(network), name, image.tobytes()) for image in each.numpy())
            return activations(network, images, *options)

        return counted

    def clear(self) -> None:
        self.networks.clear()
        self.views.clear()


@pytest.fixture
def passes(monkeypatch) -> Passes:
    return Passes(monkeypatch)


class Shown:
    """An environment that shows states one after the other, whatever is done."""

    def __init__(self, spec: TaskSpec, samples: Samples) -> None:
        self.spec = spec
        self.samples = samples
        self.at = 0

    def reset(self, seed: int) -> Observation:
        del seed
        self.at = 0
        return self._observation()

    def step(self, action: Action) -> Transition:
        del action
        self.at += 1
        last = self.at == len(self.samples) - 1
        return Transition(self._observation(), 0.0, last, truncated=False)

    def outcome(self) -> Outcome:
        return Outcome.TIME_LIMIT

    def metrics(self) -> Mapping[str, float]:
        return {}

    def state(self) -> NDArray[np.float64]:
        return np.array([float(self.at)])

    def _observation(self) -> Observation:
        images = {name: images[self.at] for name, images in self.samples.images.items()}
        return Observation(images, self.samples.features[self.at], float(self.at))


class Labelling:
    """An expert that does nothing in particular."""

    def __init__(self, action: Action) -> None:
        self.action = action

    def reset(self) -> None:
        pass

    def act(self, observation: Observation) -> Action:
        del observation
        return self.action


def fitted(looking: Looking) -> Signal:
    signal = make_signal(looking.choice)
    signal.fit(looking.training.labels, look_to_fit(looking.policy, looking.training, signal))
    seen = look(looking.policy, looking.held_out, signal.attach(looking.policy))
    return signal.calibrate([signal.measure(seen)])


def test_in_a_control_step(looking, passes):
    signal = fitted(looking)
    states = looking.held_out.take(np.arange(12))
    measures = signal.measure(look(looking.policy, states, signal.attach(looking.policy)))
    # Half of the steps are outside, so that expert and policy take turns.
    threshold = float(np.median(signal.scores(measures)))
    gate = SupportGate(FittedGate(GateConfig(), looking.policy, signal), threshold)
    environment = Shown(looking.spec, states)
    info = EpisodeInfo(looking.spec.name, 0, Purpose.LEARNING, looking.spec.control_rate_hz)
    passes.clear()
    episode = rollout(
        environment,  # pyright: ignore[reportArgumentType]
        info,
        gate,
        rng=np.random.default_rng(0),
        policy=looking.policy,
        expert=Labelling(looking.training.labels[0]),
    )
    assert len(episode) == 11
    assert {step.decision.actor for step in episode.steps} == {Actor.POLICY, Actor.EXPERT}
    cameras = len(looking.spec.cameras)
    assert len(passes.networks) == len(episode) * cameras * looking.networks
    assert set(passes.networks.values()) == {1}
    if looking.spec.tool_frame is not None:
        assert len(passes.views) == len(episode)
        assert set(passes.views.values()) == {1}
    else:
        assert not passes.views


def test_in_the_fit_of_a_signal_and_its_calibration(looking, passes):
    signal = make_signal(looking.choice)
    passes.clear()
    seen = look_to_fit(looking.policy, looking.training, signal)
    signal.fit(looking.training.labels, seen)
    held_out = look(looking.policy, looking.held_out, signal.attach(looking.policy))
    measures = signal.measure(held_out)
    signal.calibrate([measures]).scores(measures)
    assert (seen.displaced is not None) == signal.uses_displaced
    displaced = 0 if seen.displaced is None else len(seen.displaced)
    states = len(looking.training) + displaced + len(looking.held_out)
    cameras = len(looking.spec.cameras)
    assert len(passes.networks) == states * cameras * looking.networks
    assert set(passes.networks.values()) == {1}
    assert len(passes.views) == (states if looking.spec.tool_frame is not None else 0)
    assert set(passes.views.values()) <= {1}


def test_equal_readers_share_a_reading():
    looking = CASES["driving"]()
    signal = make_signal(looking.choice)
    readers = signal.attach(looking.policy)
    # Of the convolutions the middle is read by the support and the precedent.
    names = ["LayerOnGrid", "MiddleOfLastLayer", "ShrunkPixels", "ShrunkPixels"]
    assert sorted(type(reader).__name__ for reader in readers) == names
    seen = look(looking.policy, looking.held_out.take(np.arange(3)), readers)
    assert set(seen.readings) == set(readers)
    assert len(seen.readings) == len(readers) == 4
    # One that was made apart finds the same.
    again = make_signal(looking.choice).attach(looking.policy)
    assert {reader: seen.readings[reader].shape for reader in again} == {
        reader: reading.shape for reader, reading in seen.readings.items()
    }


def test_a_proposal_is_seen_as_the_state_is_looked_at(looking):
    signal = make_signal(looking.choice)
    readers = signal.attach(looking.policy)
    alone = looking.held_out.take(np.arange(1))
    whole = look(looking.policy, alone, readers)
    observation = Shown(looking.spec, looking.held_out).reset(0)
    seen = seen_in(observation, looking.policy.propose(observation.alone), readers)
    np.testing.assert_array_equal(seen.actions, whole.actions)
    np.testing.assert_array_equal(seen.features, whole.features)
    for reader in readers:
        np.testing.assert_array_equal(seen.readings[reader], whole.readings[reader])
