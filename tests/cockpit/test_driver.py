"""Any driver with a person beside it: who may act then, and under which gate."""

from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.cockpit import Cockpit, OperatedEnvironment, Operator, PersonGate
from sheath_manip.cockpit.driver import OperatedDriver
from sheath_manip.controllers.hold import Hold
from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.learning.drivers import ExpertAlone, GivenPolicy
from sheath_manip.rollout.request import EpisodeRequest
from sheath_manip.rollout.workplace import Workplace
from sheath_manip.task import SCRIPTED
from sheath_manip.types import Actor, EpisodeInfo, Purpose
from tests.toy import CORRIDOR, Corridor, MiddleKeeper, teleop
from tools.scripted_person import Absent

STRAIGHT = GivenPolicy(Absent(lambda: np.zeros(1, np.float32)))


@pytest.fixture
def cockpit() -> Cockpit:
    return Cockpit(teleop(Corridor()).guide)


@pytest.mark.parametrize(
    ("fallback", "kind", "teaches"), [(SCRIPTED, MiddleKeeper, True), ("hold", Hold, False)]
)
def test_the_persons_gate_lies_around_the_other_drivers(cockpit, fallback, kind, teaches):
    driver = OperatedDriver(STRAIGHT, cockpit, fallback=fallback, hold="hold", wait_s=2.0)
    inner = Corridor()
    crew = driver.crew(CORRIDOR, OperatedEnvironment(inner, cockpit))
    assert crew.policy is STRAIGHT.policy
    assert isinstance(crew.gate, PersonGate)
    assert (crew.gate.wait_s, crew.gate.can_hold, crew.gate.fallback_teaches) == (
        2.0,
        True,
        teaches,
    )
    kinds = {actor: type(one) for actor, one in crew.others.items()}
    assert kinds == {Actor.OPERATOR: Operator, Actor.HOLD: Hold, Actor.FALLBACK: kind}


def test_without_a_controller_that_holds_the_simulation_stands_still(cockpit):
    gate = OperatedDriver(STRAIGHT, cockpit).crew(CORRIDOR, Corridor()).gate
    assert isinstance(gate, PersonGate)
    assert not gate.can_hold


@pytest.mark.parametrize(
    ("wait_s", "actors"),
    [
        (0.0, {Actor.FALLBACK}),
        (0.1, {Actor.HOLD, Actor.FALLBACK}),
        (1.0, {Actor.HOLD}),
    ],
)
def test_where_the_expert_is_asked_for_and_nobody_comes(cockpit, wait_s, actors):
    driver = OperatedDriver(ExpertAlone(), cockpit, hold="hold", wait_s=wait_s)
    info = EpisodeInfo.of(Corridor().spec, variant="default", seed=3, purpose=Purpose.DEMONSTRATION)
    with Workplace() as workplace:
        episode = workplace.run(EpisodeRequest(CORRIDOR, info, driver))
    assert {step.decision.actor for step in episode.steps} == actors


def test_a_task_without_teleop_and_an_unknown_fallback_are_refused(cockpit):
    with pytest.raises(ParameterError, match="nobody can drive corridor by hand"):
        OperatedDriver(STRAIGHT, cockpit).crew(replace(CORRIDOR, teleop=None), Corridor())
    with pytest.raises(UnknownNameError, match="drift"):
        OperatedDriver(STRAIGHT, cockpit, fallback="drift").crew(CORRIDOR, Corridor())
