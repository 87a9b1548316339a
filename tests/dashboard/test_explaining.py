"""Why a gate asks: the sentence, the states like it, and where the proposal would lead."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from sheath_manip.dashboard import explanation_markup
from sheath_manip.dashboard.action_words import wish
from sheath_manip.dashboard.explainer import Explainer, Wish
from sheath_manip.dashboard.explaining import Explanation, Moment, did, explained
from sheath_manip.dashboard.ghost import ghosts, state_after
from sheath_manip.types import (
    ActionSpec,
    Actor,
    Breakdown,
    EpisodeInfo,
    GateDecision,
    Observation,
    Outcome,
    Purpose,
    Reason,
    ScenePose,
    SignalScore,
    TaskSpec,
    Transition,
)
from sheath_manip.types.seen import Precedents
from tests.waiting import eventually

STEERING = ActionSpec(
    ("steering_rad",),
    np.array([-1.0], np.float32),
    np.array([1.0], np.float32),
    choices=np.array([[-1.0], [0.0], [1.0]], np.float32),
    choice_words=("go right", "go straight", "go left"),
)
ARM = ActionSpec(("velocity_x_m_per_s", "grip"), -np.ones(2, np.float32), np.ones(2, np.float32))
LEFT = np.array([1.0], np.float32)
OBSERVATION = Observation({"front": np.zeros((4, 6, 3), np.uint8)}, np.zeros(1, np.float32), 0.0)


def moment(
    proposed: NDArray | None,
    *signals: tuple[str, float],
    score: float = -5.0,
    reason: Reason = Reason.RISK,
) -> Moment:
    scores = tuple(SignalScore(name, -1.0, share) for name, share in sorted(signals))
    decision = GateDecision(Actor.EXPERT, True, reason, score, -4.0, signals=scores)
    return Moment(OBSERVATION, proposed, None, decision)


def precedents(labels: NDArray, proposed: NDArray) -> Precedents:
    count = len(labels)
    return Precedents(
        np.arange(count), np.linspace(0.1, 1, count), labels.astype(np.float32), proposed, 5 * count
    )


def test_it_says_what_the_policy_wants_and_what_experts_did() -> None:
    labels = np.repeat([[0.0], [1.0], [-1.0]], [97, 2, 1], axis=0)
    asked = moment(LEFT, ("support", 0.4), ("precedent", 0.004))
    told, rang = explained(asked, STEERING, precedents(labels, LEFT), 5000)
    assert rang == "precedent"
    assert told == (
        "The policy wants to go left; of the 100 expert steps in the states most like this one 97% "
        "were to go straight, 2% as the policy wants: of 5,000 held-out expert steps 20 scored "
        "lower."
    )
    usual = np.zeros(1, np.float32)
    told, _ = explained(moment(usual, ("precedent", 0.0)), STEERING, precedents(labels, usual), 0)
    assert "97% did so, too, but even the nearest is far away" in told
    assert told.endswith("no held-out expert step scored lower.")
    told, _ = explained(moment(LEFT, ("precedent", 0.01)), STEERING, None, 0)
    assert told.startswith("The expert has hardly ever done what the policy wants")


def test_of_continuous_actions_it_names_the_dimension_that_is_off() -> None:
    labels = np.stack([np.linspace(0.1, 0.2, 50), np.linspace(-1, 1, 50)], axis=1)
    wanted = np.array([-0.4, 0.0], np.float32)
    asked = moment(wanted, ("precedent", 0.001), ("support", 0.5))
    told, _ = explained(asked, ARM, precedents(labels, wanted), 100_000)
    assert "wants velocity x -0.40" in told
    assert "90 % have it between +0.10 and +0.19 m/s: 0.1% of held-out" in told


def test_it_says_which_signal_rang_or_that_none_did() -> None:
    told, rang = explained(moment(LEFT, ("support", 0.01), ("precedent", 0.3)), STEERING, None)
    assert rang == "support"
    assert told.startswith("This state is unlike those that the policy was trained on")
    told, _ = explained(moment(LEFT, ("support", 0.1), ("precedent", 0.2)), STEERING, None)
    assert told.startswith("Several mild suspicions add up.")
    told, rang = explained(moment(LEFT, ("support", 0.5), score=0.0), STEERING, None)
    assert (rang, told[:29]) == ("", "The gate lets the policy act.")
    told, _ = explained(moment(LEFT, ("support", np.nan)), STEERING, None)
    assert told.endswith("how rare that is among expert steps is not known.")


@pytest.mark.parametrize("reason", list(Reason))
def test_every_reason_has_a_sentence(reason: Reason) -> None:
    for score in (np.nan, -5.0, 0.0):
        for signals in ((), (("support", 0.2),)):
            told, _ = explained(moment(None, *signals, score=score, reason=reason), STEERING, None)
            assert told.endswith(".")
            assert told[0].isupper()


def test_what_broke_down_is_said_where_there_is_nothing_to_judge() -> None:
    asked = moment(None, score=np.nan, reason=Reason.WAITING)
    broken = replace(asked.decision, broken=(Breakdown("policy", "late"),))
    told, _ = explained(replace(asked, decision=broken), STEERING, None)
    assert "broke down (policy: late)" in told


def test_actions_in_words() -> None:
    buttons = replace(
        STEERING,
        names=("right", "jump"),
        choices=np.array([[0, 0], [1, 1]], np.float32),
        choice_words=(),
    )
    assert [wish(buttons, np.array(each, np.float32)) for each in ([0, 0], [1, 1])] == [
        "press nothing",
        "press right and jump",
    ]
    assert did(ARM, np.array([0.5, 0.0])) == "velocity x +0.50"
    assert did(ARM, np.zeros(2)) == "hardly moved"


def test_markup_escapes_and_takes_what_is_missing() -> None:
    bare = Explanation("a <b>", "", moment(None), lacks="<i>")
    full = Explanation(
        "why", "support", moment(LEFT, ("support", 0.01)), precedents(np.zeros((9, 1)), LEFT)
    )
    arm = Explanation("why", "", moment(np.zeros(2, np.float32)))
    for explanation, spec in ((bare, STEERING), (full, STEERING), (arm, ARM)):
        text = (
            explanation_markup.sentence(explanation)
            + explanation_markup.figures(explanation, spec)
            + explanation_markup.signals(explanation)
            + explanation_markup.actions(explanation, spec)
        )
        assert "<i>" not in text
        assert "a <b>" not in text
        assert "data:image/png;base64," in text


class Yard:
    """A tool that goes where it is told, and something that moves by itself."""

    spec = TaskSpec("yard", 10.0, STEERING, {}, ("x",), 100, "x")

    def __init__(self) -> None:
        self._at = np.zeros(2)
        self.closed = False

    def reset(self, seed: int) -> Observation:
        self._at = np.array([float(seed), 0.0])
        return OBSERVATION

    def step(self, action: NDArray) -> Transition:
        self._at = self._at + np.array([float(action[0]), 1.0])
        return Transition(OBSERVATION, 0.0, False, False)

    def outcome(self) -> Outcome:
        return Outcome.TIME_LIMIT

    def metrics(self) -> dict[str, float]:
        return {"x": 0.0}

    def close(self) -> None:
        self.closed = True

    def state(self) -> NDArray[np.float64]:
        return self._at.copy()

    def restore(self, state: NDArray[np.float64]) -> Observation:
        self._at = state.copy()
        return OBSERVATION

    def scene(self) -> tuple:
        return ()

    def pose(self) -> ScenePose:
        bodies = np.zeros((3, 7))
        bodies[0, 0], bodies[1, 0] = self._at
        return ScenePose(bodies, np.array([self._at[0], 0.0, 0.0]))

    def pose_at(self, state: NDArray[np.float64]) -> ScenePose:
        self.restore(state)
        return self.pose()


def test_a_ghost_goes_a_second_ahead_and_has_what_the_action_moves() -> None:
    straight = np.zeros(1, np.float32)
    left, still = ghosts(Yard(), np.array([2.0, 0.0]), [LEFT, straight])
    np.testing.assert_allclose(left.way_m[:, 0], np.arange(2.0, 13.0))
    assert left.bodies.tolist() == [0]
    assert left.pose.bodies[0, 0] == 12.0
    # What is to stand still moves nothing, though the other would have gone on.
    assert still.bodies.tolist() == []
    assert state_after(Yard(), np.zeros(2), LEFT).tolist() == [1.0, 1.0]


def test_the_explainer_works_on_its_own_thread_and_begins_again_after_its_end() -> None:
    made: list[Yard] = []

    def make(info: EpisodeInfo) -> Yard:
        del info
        made.append(Yard())
        return made[-1]

    info = EpisodeInfo("yard", 1, Purpose.LEARNING, 10.0)
    explainer = Explainer(Yard.spec, None, make)
    for number in range(2):
        asked = Wish((number,), info, moment(LEFT, ("support", 0.01)), (np.zeros(2), LEFT))

        def is_done(asked: Wish = asked) -> bool:
            found = explainer.wish(asked)
            return found is not None and len(found.ghosts) == 1

        assert eventually(is_done)
        found = explainer.wish(asked)
        assert found is not None
        assert found.ghosts[0].way_m[0, 0] == 1.0
        assert explainer.latest is not None
        assert "not known here" in explainer.latest.explanation.lacks
        assert explainer.wish(None) is None
        explainer.close()
        assert eventually(lambda number=number: made[number].closed)
    assert len(made) == 2


def test_without_a_state_no_environment_is_made() -> None:
    def make(info: EpisodeInfo) -> Yard:
        raise AssertionError(f"there may be a robot behind the environment of {info}")

    explainer = Explainer(Yard.spec, None, make)
    info = EpisodeInfo("yard", 1, Purpose.LEARNING, 10.0)
    asked = Wish((0,), info, moment(LEFT, ("support", 0.01)), None)
    assert eventually(lambda: explainer.wish(asked) is not None)
    found = explainer.wish(asked)
    assert found is not None
    assert found.ghosts == ()
    explainer.close()
