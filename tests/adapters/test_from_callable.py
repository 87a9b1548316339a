"""Any function that says what to do is a policy that a gate can be fitted around."""

import numpy as np
import pytest

from sheath_manip.adapters.from_callable import from_callable
from sheath_manip.exceptions import ParameterError
from sheath_manip.gates import SupportGate
from sheath_manip.protocols import Replans
from sheath_manip.testing import check_policy
from sheath_manip.types import (
    ActionSpec,
    Actor,
    Judgement,
    Observation,
    Observations,
    Proposal,
    TaskSpec,
)
from tests.rollout.corridor_episode import Scripted, run
from tests.toy import CHOICES, Corridor

ONE = np.ones(2, np.float32)
ACTION = ActionSpec(("left", "right"), -9 * ONE, 9 * ONE)
SPEC = TaskSpec("mine", 10.0, ACTION, {}, ("a", "b"), 100, "x")


def seen(*rows: float, told: str = "") -> Observations:
    features = np.array([[row, 0.0] for row in rows], np.float32)
    return Observations({}, features, (told,) * len(rows) if told else None)


class Counted:
    """Answers its features, as chunks of so many, and remembers what it was shown."""

    def __init__(self, chunk: int = 0) -> None:
        self.chunk = chunk
        self.shown: list[np.ndarray] = []

    def __call__(self, observation: Observation | Observations) -> np.ndarray:
        self.shown.append(observation.features)
        if not self.chunk:
            return observation.features
        steps = np.arange(self.chunk)[:, None]
        return observation.features[..., None, :] + 0.1 * steps


def test_one_observation_or_a_batch() -> None:
    for batched, shape in ((False, (2,)), (True, (3, 2))):
        act = Counted()
        policy = from_callable(act, batched=batched)
        np.testing.assert_array_equal(policy.predict(seen(1, 2, 3)).actions[:, 0], [1, 2, 3])
        assert act.shown[0].shape == shape
        assert policy.propose(seen(4)).now.dtype == np.float32
    check_policy(lambda spec, **_: from_callable(Counted(), action=spec.action), SPEC)


def test_an_instruction_is_shown_and_a_clock_is_not() -> None:
    told: list[tuple[str, float]] = []

    def act(observation: Observation) -> np.ndarray:
        told.append((observation.instruction, observation.time_s))
        return observation.features

    policy = from_callable(act)
    policy.propose(Observation({}, ONE, 3.0, "fold the cloth").alone)
    policy.predict(seen(1, 2))
    assert [text for text, _ in told] == ["fold the cloth", "", ""]
    assert np.isnan([time_s for _, time_s in told]).all()


@pytest.mark.parametrize("batched", [False, True])
def test_a_chunk_is_played_with_one_call(batched: bool) -> None:
    act = Counted(chunk=3)
    policy = from_callable(act, batched=batched)
    assert isinstance(policy, Replans)
    played = [policy.propose(seen(step)).now[0, 0] for step in range(7)]
    np.testing.assert_allclose(played, [0, 0.1, 0.2, 3, 3.1, 3.2, 6], atol=1e-6)
    assert len(act.shown) == 3
    assert policy.predict(seen(1, 2)).actions.shape == (2, 3, 2)
    policy.reset(np.random.default_rng(0))
    assert policy.propose(seen(8)).now[0, 0] == 8


def test_what_was_planned_is_void_once_somebody_else_has_acted() -> None:
    class LeftOfTheMiddle:
        def judge(self, observation, proposal, threshold):
            del proposal, threshold
            return Judgement(-float(observation.features[0]))

    planned_at: list[float] = []

    def act(observation: Observation) -> np.ndarray:
        planned_at.append(float(observation.features[1]))
        return CHOICES[[2, 2, 2, 2]]

    gate, expert = SupportGate(LeftOfTheMiddle(), 0.0), Scripted(lambda _: CHOICES[0])
    steps = run(gate, from_callable(act), expert, environment=Corridor(steps=40)).steps
    by_policy = [step.decision.actor is Actor.POLICY for step in steps]
    assert 0 < sum(by_policy) < len(steps)
    after_another = [t for t in range(1, len(steps)) if not by_policy[t - 1]]
    assert set(after_another) <= {int(t) for t in planned_at}
    # The action that is judged is the one that is executed.
    for step in steps:
        if step.decision.actor is Actor.POLICY:
            np.testing.assert_array_equal(step.executed, step.proposed)


def test_history_goes_on_while_a_chunk_is_played_and_begins_anew_with_an_episode() -> None:
    shown: list[list[float]] = []

    def remember(observation: Observation) -> np.ndarray:
        shown.append(observation.features[:, 0].tolist())
        return np.zeros((2, 2), np.float32)

    policy = from_callable(remember, history=3)
    for step in range(5):
        policy.propose(seen(step))
    assert shown == [[0, 0, 0], [0, 1, 2], [2, 3, 4]]
    policy.reset(np.random.default_rng(0))
    policy.propose(seen(9))
    assert shown[-1] == [9, 9, 9]
    policy.predict(seen(7, 8))
    assert shown[-2:] == [[7, 7, 7], [8, 8, 8]]


def test_its_own_reset_is_given_what_to_draw_from() -> None:
    drawn: list[np.random.Generator] = []
    policy = from_callable(lambda _: drawn[-1].normal(size=2), reset=drawn.append)
    policy.reset(np.random.default_rng(3))
    first = policy.propose(seen(0)).now
    policy.reset(np.random.default_rng(3))
    np.testing.assert_array_equal(policy.propose(seen(0)).now, first)


def test_a_proposal_with_latents_comes_through() -> None:
    def act(observation: Observation) -> Proposal:
        return Proposal(observation.features[None], {"hidden": observation.features[None, :1]})

    policy = from_callable(act)
    np.testing.assert_array_equal(policy.predict(seen(5, 6)).latents["hidden"], [[5], [6]])


def test_losses_are_shares_of_the_range_or_choices() -> None:
    labels = np.array([[0.0, 0.0], [0.0, 0.0]], np.float32)
    proposal = Proposal(np.array([[0.5, 0.0], [9.0, 0.0]], np.float32))
    losses = from_callable(Counted()).surrogate_losses(proposal, labels)
    np.testing.assert_allclose(losses, [0.25, 1.0])
    chosen = from_callable(Counted(), action=Corridor().spec.action)
    np.testing.assert_array_equal(
        chosen.surrogate_losses(Proposal(CHOICES), CHOICES[[0, 0, 2]]), [0, 1, 0]
    )


def test_what_is_no_answer_is_said_in_one_line() -> None:
    with pytest.raises(ParameterError, match="history is 0; wanted at least 1"):
        from_callable(Counted(), history=0)
    for answer in (0.5, np.zeros((2, 2, 2, 2)), np.zeros((0, 2))):
        with pytest.raises(ParameterError, match=r"wanted \(n, a\) actions"):
            from_callable(lambda _, answer=answer: answer).propose(seen(0))
