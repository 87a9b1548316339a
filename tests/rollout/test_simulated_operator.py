"""A simulated operator reacts late, stays a while, overlooks and slips; all of it by its seed."""

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.rollout.simulated_operator import (
    OperatorConfig,
    OperatorHand,
    SimulatedOperator,
)
from sheath_manip.types import Observation
from tests.toy import ACTION, CHOICES, Corridor, MiddleKeeper

PERIOD_S = 0.1
SEEN = Observation({}, np.zeros(1, np.float32), 0.0)


def begun(seed: int = 0, **settings) -> SimulatedOperator:
    operator = SimulatedOperator(OperatorConfig(**settings))
    operator.begin(np.random.default_rng(seed))
    return operator


def driving(operator: SimulatedOperator, trouble: list[bool]) -> list[bool]:
    return [operator.drives(each, step * PERIOD_S) for step, each in enumerate(trouble)]


def test_he_takes_over_once_his_reaction_is_over_and_hands_back_as_late():
    operator = begun(reaction_s=0.5, reaction_spread_s=0.0, attention_s=0.0)
    drives = driving(operator, [True] * 10 + [False] * 10)
    assert drives == [False] * 5 + [True] * 10 + [False] * 5


def test_he_stays_for_as_long_as_he_attends():
    operator = begun(reaction_s=0.2, reaction_spread_s=0.0, attention_s=1.0)
    drives = driving(operator, [True] * 3 + [False] * 20)
    # From .2 s on, for 1 s at least, and then his reaction.
    assert sum(drives) == 12


def test_what_passes_before_he_reacts_he_does_not_act_upon():
    operator = begun(reaction_s=0.5, reaction_spread_s=0.0)
    assert not any(driving(operator, ([True] * 4 + [False]) * 6))


def test_his_reactions_have_the_mean_and_the_spread_that_were_asked_for():
    operator, waits_s = begun(), []
    for _ in range(400):
        operator.leave()
        now_s = 0.0
        while not operator.drives(True, now_s):
            now_s += 0.01
        waits_s.append(now_s)
    assert np.mean(waits_s) == pytest.approx(1.2, abs=0.05)
    assert np.std(waits_s) == pytest.approx(0.3, abs=0.05)


def test_the_same_seed_gives_the_same_person():
    trouble = [step % 40 < 25 for step in range(400)]
    same, again, other = (driving(begun(seed), trouble) for seed in (3, 3, 4))
    assert same == again != other
    assert any(same)


def test_what_he_overlooks_he_never_notices():
    noticed = sum(any(driving(begun(seed, overlooked=0.3), [True] * 60)) for seed in range(100))
    assert 55 <= noticed <= 85


def hand(operator: SimulatedOperator) -> OperatorHand:
    environment = Corridor()
    environment.reset(0)
    environment.side_m = 0.0
    return OperatorHand(MiddleKeeper(environment), operator, ACTION, 1 / PERIOD_S)


def test_his_hand_slips_as_often_and_as_long_as_it_is_said_to():
    operator = begun(slips_a_minute=20.0, slip_s=0.3)
    held = hand(operator)
    steps = [Observation({}, np.zeros(1, np.float32), step * PERIOD_S) for step in range(6000)]
    done = np.array([held.act(seen)[0] for seen in steps])
    assert set(done) <= set(CHOICES[:, 0])
    # 200 slips of three steps, of which one choice in three is what he meant.
    assert np.count_nonzero(done) == pytest.approx(200 * 3 * 2 / 3, rel=0.2)
    assert np.count_nonzero([hand(begun()).act(seen)[0] for seen in steps[:300]]) == 0


@pytest.mark.parametrize(
    "settings",
    [{"reaction_s": 0.0}, {"overlooked": 1.5}, {"slips_a_minute": -1.0}, {"attention_s": np.nan}],
)
def test_a_person_that_cannot_be_is_refused(settings):
    with pytest.raises(ParameterError, match=f"{next(iter(settings))} is"):
        OperatorConfig(**settings)
