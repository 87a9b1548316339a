"""The gate on real pictures: a few expert laps, seen small, and a small policy."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from sheath_manip.exceptions import GateWarning
from sheath_manip.gates import AlwaysExpert
from sheath_manip.gates.config import planned_signal
from sheath_manip.gates.fitted import FittedGate, Sources
from sheath_manip.gates.making import make_gate
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.fitting import fit_gate
from sheath_manip.policies import IMAGE_EMBEDDINGS, POLICIES, make_embedding
from sheath_manip.policies.cnn import ConvPolicy
from sheath_manip.protocols import PredictingPolicy, Reader
from sheath_manip.rollout.loop import rollout
from sheath_manip.signals import make_signal
from sheath_manip.signals.support import SupportSignal
from sheath_manip.support import make_support
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.driving.expert import DrivingExpert
from sheath_manip.tasks.driving.task import DrivingTask, Scenario
from sheath_manip.types import (
    Actor,
    Episode,
    EpisodeInfo,
    Observation,
    Outcome,
    Purpose,
    Reason,
)
from sheath_manip.types.samples import Samples, samples_from
from sheath_manip.types.seen import Seen
from tests.looks import fitted_embedding, vectors_of

DEMONSTRATIONS, CALIBRATION = 3, 3
FALSE_ALARM_RATE = 0.1
PLAN = LearningPlan().changed(
    policy={"name": "small-cnn"},
    gate={"signal": "support", "threshold": {"false_alarm_rate": FALSE_ALARM_RATE}},
)


class Drive:
    """An environment, expert laps in it, and a policy fitted to some of them."""

    def __init__(self) -> None:
        # 64 pixels: the least that leaves the convolutions some room.
        self.task = DrivingTask(Scenario(render_px=128, pyramid_levels=1))
        self.environment = ComposerEnvironment(self.task)
        self.expert = DrivingExpert(self.environment)
        laps = [self.lap(AlwaysExpert(), seed) for seed in range(DEMONSTRATIONS + CALIBRATION)]
        self.states = samples_from(laps[:DEMONSTRATIONS])
        self.held_out = [samples_from([lap]) for lap in laps[DEMONSTRATIONS:]]
        self.policy = ConvPolicy(self.task.spec, (8, 16), (32,), epochs=8, seed=0)
        self.policy.fit(self.states)
        # Three laps leave so many directions open that new ones lie nearly as far as anything.
        with pytest.warns(GateWarning, match="may never take over"):
            fit = fit_gate(
                self.policy, self.states, self.held_out, PLAN.gate, sources=Sources(("lap",), ())
            )
        self.fitted = fit.gate

    def lap(self, gate, seed: int) -> Episode:
        return rollout(
            self.environment,
            EpisodeInfo("driving", seed, Purpose.LEARNING, 10.0),
            gate,
            rng=np.random.default_rng(0),
            policy=getattr(self, "policy", None),
            expert=self.expert,
        )


@pytest.fixture(scope="module")
def drive():
    small = partial(ConvPolicy, channels=(8, 16), hidden=(32,))
    with POLICIES.including("small-cnn", small):
        drive = Drive()
        yield drive
        drive.environment.close()


def vectors(fitted: FittedGate, samples: Samples) -> np.ndarray:
    assert isinstance(fitted.signal, SupportSignal)
    return vectors_of(fitted.signal.embedding, fitted.policy, samples)


def score_of(fitted: FittedGate, observation: Observation) -> float:
    return fitted.judge(observation, fitted.policy.propose(observation.alone), 0.0).score


@pytest.mark.parametrize("embedding", sorted(IMAGE_EMBEDDINGS))
def test_at_most_nu_of_the_training_states_lie_outside(embedding, drive):
    fitted = fitted_embedding(make_embedding(embedding), drive.policy, drive.states)
    points = vectors_of(fitted, drive.policy, drive.states)
    for nu in (0.01, 0.05, 0.2, 0.5):
        support = make_support(PLAN.gate.support.name, nu=nu).fit(points)
        scores = support.decision_function(points)
        assert (scores >= 0).mean() >= 1 - nu - 0.01


@pytest.mark.parametrize("factor", [0.1, 10.0])
def test_so_it_is_with_other_bandwidths(factor, drive):
    points = vectors(drive.fitted, drive.states)
    for nu in (0.05, 0.5):
        support = make_support(PLAN.gate.support.name, nu=nu, bandwidth_factor=factor).fit(points)
        assert (support.decision_function(points) >= 0).mean() >= 1 - nu - 0.01


def test_the_threshold_is_met_by_the_steps_that_it_was_calibrated_on(drive):
    alarms = [
        np.mean(~(drive.fitted.scores(lap) >= drive.fitted.threshold)) for lap in drive.held_out
    ]
    assert np.mean(alarms) == pytest.approx(FALSE_ALARM_RATE, abs=0.02)


def test_off_the_road_lies_further_outside_than_on_it(drive):
    drive.environment.reset(500)
    physics = drive.environment.physics
    track = drive.task.track

    def score(lateral_m: float, turned_rad: float) -> float:
        scores = []
        for s in np.linspace(0, track.lap_length, 12, endpoint=False):
            pose = track.pose(s, np.array(lateral_m)) + np.array([0, 0, turned_rad])
            drive.task.place(physics, pose)
            physics.forward()
            scores.append(score_of(drive.fitted, drive.environment.observe()))
        return float(np.median(scores))

    middle = score(0.0, 0.0)
    assert middle > score(6.0, 0.0)
    assert middle > score(0.0, np.pi / 2)


class Blind:
    """An embedding that sees nothing."""

    uses_displaced = False

    def attach(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        del policy
        return ()

    def transform(self, seen: Seen) -> np.ndarray:
        return np.full((len(seen), 8), np.nan, np.float32)


def test_without_a_score_the_expert_drives(drive):
    support = make_support(PLAN.gate.support.name).fit(
        np.random.default_rng(0).normal(size=(50, 8))
    )
    signal = SupportSignal(Blind(), support)  # pyright: ignore[reportArgumentType]
    blind = replace(drive.fitted, signal=signal)
    episode = drive.lap(make_gate(blind), seed=20)
    assert episode.outcome is Outcome.SUCCESS
    assert {step.decision.actor for step in episode.steps} == {Actor.EXPERT}
    assert {step.decision.reason for step in episode.steps} == {Reason.NO_SCORE}
    assert all(step.proposed is not None for step in episode.steps)
    assert all(np.isnan(step.decision.score) for step in episode.steps)


def test_a_network_of_nan_leaves_the_wheel_to_the_expert(drive):
    """A fit that diverged: its actions are well-formed, its scores are not."""
    arrays = {
        key: np.full_like(array, np.nan) if array.dtype == np.float32 else array
        for key, array in drive.policy.arrays().items()
    }
    broken = ConvPolicy(drive.task.spec, (8, 16), (32,)).load(arrays)
    signal = make_signal(planned_signal(drive.fitted.config))
    signal.attach(broken)
    signal.load(drive.fitted.fitted_signal.arrays())
    fitted = replace(drive.fitted, policy=broken, signal=signal)
    seen = drive.environment.reset(3)
    assert np.isnan(score_of(fitted, seen))
    decision = make_gate(fitted).decide(seen, broken.propose(seen.alone))
    assert (decision.actor, decision.reason) == (Actor.EXPERT, Reason.NO_SCORE)


def test_under_the_gate_both_drive_and_the_scores_decide(drive):
    # As many inside as outside, whatever so small a network has learned.
    threshold = float(np.median(np.concatenate([*map(drive.fitted.scores, drive.held_out)])))
    episode = drive.lap(make_gate(replace(drive.fitted, threshold=threshold)), seed=30)
    actors = [step.decision.actor for step in episode.steps]
    assert set(actors) == {Actor.EXPERT, Actor.POLICY}
    for step in episode.steps:
        outside = step.decision.score < threshold
        assert step.decision.actor is (Actor.EXPERT if outside else Actor.POLICY)
