"""The policy that plans chunks: what it learns of them, when it decodes, and what its gate sees."""

from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates import SupportGate
from sheath_manip.policies import make_embedding, make_policy
from sheath_manip.policies.act_network import ActNetwork
from sheath_manip.protocols import Replans
from sheath_manip.types import Action, ActionSpec, Judgement, Observation, Observations, Proposal
from sheath_manip.types.columns import ACTORS
from sheath_manip.types.samples import Samples
from tests import reach
from tests.looks import fitted_embedding, vectors_of
from tests.rollout.corridor_episode import Scripted, run
from tests.toy import Corridor

SMALL = {
    "channels": (4, 4, 4, 4),
    "width": 16,
    "heads": 2,
    "layers": 1,
    "chunk": 4,
    "executed_steps": 3,
    "steps": 2,
    "warm_steps": 2,
    "batch_size": 16,
}


@pytest.fixture
def decoded(monkeypatch) -> list[int]:
    """How many states each pass of the decoder was for."""
    counts, forward = [], ActNetwork.forward

    def counted(self, layers, features):
        counts.append(len(features))
        return forward(self, layers, features)

    monkeypatch.setattr(ActNetwork, "forward", counted)
    return counts


def rows_of(samples: Samples, count: int) -> list[Observations]:
    return [samples.observations.rows(slice(row, row + 1)) for row in range(count)]


def test_one_pass_of_the_decoder_gives_a_plan_and_every_step_a_look(decoded):
    policy, samples = reach.fitted_policy("act"), reach.held_out()
    decoded.clear()
    policy.reset(np.random.default_rng(0))
    proposals = [policy.propose(row) for row in rows_of(samples, 6)]
    assert decoded == [1, 1]
    assert [proposal.actions.shape[1] for proposal in proposals] == [3, 2, 1, 3, 2, 1]
    predicted = policy.predict(samples.observations.rows(slice(0, 6)))
    assert predicted.actions.shape == (6, 4, 2)
    for place, proposal in enumerate(proposals):
        # The plan of the first look, the latents of the present one.
        first = 3 * (place // 3)
        wanted = predicted.actions[first, place - first]
        np.testing.assert_allclose(proposal.now[0], wanted, atol=1e-4)
        for camera in reach.SPEC.cameras:
            latent = f"convolution {camera}"
            seen = np.asarray(predicted.latents[latent])[place]
            np.testing.assert_allclose(np.asarray(proposal.latents[latent])[0], seen, atol=1e-4)


def test_it_decodes_anew_once_somebody_else_has_acted(decoded):
    policy, rows = reach.fitted_policy("act"), rows_of(reach.held_out(), 3)
    decoded.clear()
    policy.reset(np.random.default_rng(0))
    policy.propose(rows[0])
    assert isinstance(policy, Replans)
    policy.replan()
    fresh = policy.propose(rows[1])
    assert decoded == [1, 1]
    np.testing.assert_allclose(fresh.now, policy.predict(rows[1]).now, atol=1e-4)
    policy.propose(rows[2])
    # To predict draws nothing and leaves the plan as it is.
    assert decoded == [1, 1, 1]


CORRIDOR = replace(
    Corridor().spec,
    action=ActionSpec(("sidestep_m",), np.array([-0.3], np.float32), np.array([0.3], np.float32)),
)


def corridor_policy():
    rng = np.random.default_rng(0)
    images = {"above": rng.integers(0, 255, (32, 64, 64, 3), dtype=np.uint8)}
    features = rng.normal(size=(32, 2)).astype(np.float32)
    labels = rng.uniform(-0.3, 0.3, (32, 1)).astype(np.float32)
    samples = Samples(images, features, labels, np.arange(32) // 16)
    return make_policy("act", CORRIDOR, **SMALL).fit(samples)


class Wandering(Corridor):
    """The corridor with continuous sidesteps."""

    def __init__(self, steps: int) -> None:
        super().__init__(steps)
        self.spec = CORRIDOR


class OnceInFive:
    """Judges badly of every fifth proposal, and remembers all."""

    def __init__(self) -> None:
        self.judged: list[Action] = []

    def judge(self, observation: Observation, proposal: Proposal, threshold: float) -> Judgement:
        del observation, threshold
        self.judged.append(proposal.now[0])
        return Judgement(-1.0 if len(self.judged) % 5 == 0 else 1.0)


def test_what_the_gate_judges_is_executed_and_a_takeover_voids_the_plan(decoded):
    policy = corridor_policy()
    decoded.clear()
    judge = OnceInFive()
    expert = Scripted(lambda _: np.zeros(1, np.float32))
    steps = run(
        SupportGate(judge, 0.0), policy, expert, environment=Wandering(steps=12), seed=1
    ).steps
    assert len(judge.judged) == len(steps) >= 7
    plan, plans = 0, 0
    for judged, step in zip(judge.judged, steps, strict=True):
        np.testing.assert_array_equal(judged, step.proposed)
        plans += plan == 0
        plan = (plan + 1) % 3
        if str(step.decision.actor) == "policy":
            np.testing.assert_array_equal(step.executed, judged)
        else:
            plan = 0
    assert len(decoded) == plans


def test_actions_behind_a_gap_count_nothing_in_training():
    samples = reach.training().take(np.arange(48))
    expert = ACTORS.index("expert")
    alternating = np.where(np.arange(48) % 2, expert, expert + 1).astype(np.uint8)
    apart = replace(samples, actors=alternating)
    alone = replace(samples, episodes=np.arange(48))
    first, second = (make_policy("act", reach.SPEC, **SMALL).fit(each) for each in (apart, alone))
    whole = make_policy("act", reach.SPEC, **SMALL).fit(samples)
    for name, array in first.arrays().items():
        np.testing.assert_array_equal(array, second.arrays()[name])
    assert any((array != whole.arrays()[name]).any() for name, array in first.arrays().items())


@pytest.mark.parametrize("name", ["camera-convolutions:wrist", "image-points"])
def test_embeddings_of_cameras_look_through_it(name):
    policy, states = reach.fitted_policy("act"), reach.training().take(np.arange(60))
    embedding = fitted_embedding(make_embedding(name), policy, states)
    assert np.isfinite(vectors_of(embedding, policy, states)).all()


def test_what_it_cannot_be_is_said():
    with pytest.raises(ParameterError, match="wanted 1 to the 4 actions"):
        make_policy("act", reach.SPEC, **{**SMALL, "executed_steps": 5})
    with pytest.raises(ParameterError, match="multiple of the 3 heads"):
        make_policy("act", reach.SPEC, **{**SMALL, "heads": 3}).fit(reach.training())
    with pytest.raises(ParameterError, match=r"wanted continuous ones .* cnn and hog-svm"):
        make_policy("act", Corridor().spec)
    tiny = replace(reach.SPEC, cameras={"above": (12, 12)})
    with pytest.raises(ParameterError, match="too small"):
        make_policy("act", tiny).fit(reach.training())
