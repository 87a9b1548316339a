"""Any driver with a person beside it: who may act then, and under which gate."""

import threading
from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.cockpit import Cockpit, OperatedEnvironment, Operator, Order, PersonGate
from sheath_manip.cockpit.driver import OperatedDriver
from sheath_manip.cockpit.shown import Shown
from sheath_manip.controllers.hold import Hold
from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.gates import AlwaysPolicy, HumanGate
from sheath_manip.gates.labels.every_step import EveryStep
from sheath_manip.gates.labels.gate import LabellingGate
from sheath_manip.gates.patient import FOR_PEOPLE, PatientGate, RequestConfig
from sheath_manip.learning.drivers import ExpertAlone, GivenPolicy
from sheath_manip.rollout.deciding import GuardedGate
from sheath_manip.rollout.request import Crew, EpisodeRequest
from sheath_manip.rollout.simulated_operator import OperatorConfig
from sheath_manip.rollout.workplace import Workplace
from sheath_manip.task import SCRIPTED
from sheath_manip.types import Actor, EpisodeInfo, Observation, Proposal, Purpose
from tests.contracts.test_gates import watching
from tests.toy import CORRIDOR, Corridor, MiddleKeeper, teleop
from tests.waiting import DEADLINE_S, eventually
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


@pytest.mark.parametrize("wait_s", [0.0, 0.1])
def test_where_the_expert_is_asked_for_and_nobody_comes(cockpit, wait_s):
    driver = OperatedDriver(ExpertAlone(), cockpit, hold="hold", wait_s=wait_s)
    info = EpisodeInfo.of(Corridor().spec, variant="default", seed=3, purpose=Purpose.DEMONSTRATION)
    with Workplace() as workplace:
        episode = workplace.run(EpisodeRequest(CORRIDOR, info, driver))
    assert {step.decision.actor for step in episode.steps} == {Actor.FALLBACK}
    waited_s = [step.decision.waited_s for step in episode.steps]
    assert wait_s <= waited_s[0] <= wait_s + 1.0
    assert set(waited_s[1:]) == {0.0}


class Robot(Corridor):
    """One that is brought to rest, as no simulation need be."""

    held = 0

    def hold(self) -> None:
        self.held += 1


@pytest.mark.parametrize("gated", [True, False])
def test_a_robot_is_brought_to_rest_where_a_stop_makes_the_loop_stand_still(cockpit, gated):
    robot = Robot()
    environment = OperatedEnvironment(robot, cockpit)
    seen = environment.reset(3)
    # Without a controller that holds it: the loop stands still under the gate, too.
    gate = OperatedDriver(STRAIGHT, cockpit).crew(CORRIDOR, environment).gate
    gate.reset(np.random.default_rng(0))
    cockpit.gated = gated
    cockpit.order(Order.STOP, "page")
    assert robot.held == 0

    def step() -> None:
        if gated:
            gate.decide(seen, Proposal(np.zeros((1, 1), np.float32)))
        environment.step(np.zeros(1, np.float32))

    stepping = threading.Thread(target=step, daemon=True)
    stepping.start()
    assert eventually(lambda: robot.held == 1)
    assert cockpit.order(Order.RESET, "page", shown=Shown(stops=1))
    assert cockpit.order(Order.RESUME, "page")
    stepping.join(DEADLINE_S)
    assert not stepping.is_alive()
    assert robot.held == 1


def test_a_robot_is_brought_to_rest_where_a_paused_run_waits(cockpit):
    robot = Robot()
    cockpit.wait(robot)
    assert robot.held == 0
    cockpit.pause()
    waiting = threading.Thread(target=cockpit.wait, args=(robot,), daemon=True)
    waiting.start()
    assert eventually(lambda: robot.held == 1)
    cockpit.resume()
    waiting.join(DEADLINE_S)
    assert not waiting.is_alive()
    assert robot.held == 1


def test_a_robot_is_held_step_by_step_while_it_waits(cockpit):
    for inner, stands_still in ((Corridor(), True), (Robot(), False)):
        gate = OperatedDriver(STRAIGHT, cockpit, hold="hold").crew(CORRIDOR, inner).gate
        assert isinstance(gate, PersonGate)
        assert gate.stands_still is stands_still


class Limited:
    """A driver whose gate brings limits of its own, or leaves it to a person when to take over."""

    def __init__(self, gate) -> None:
        self.gate = gate

    def crew(self, task, environment) -> Crew:
        return Crew(self.gate, expert=task.make_expert(environment))


def test_the_limits_on_requests_are_the_gates_own_where_it_has_some(cockpit):
    own = RequestConfig(turn_s=7.0)
    patient = PatientGate(AlwaysPolicy(), own)
    for gate, limits in (
        (AlwaysPolicy(), FOR_PEOPLE),
        (patient, own),
        (LabellingGate(patient, [EveryStep()]), own),
    ):
        made = OperatedDriver(Limited(gate), cockpit).crew(CORRIDOR, Corridor()).gate
        assert isinstance(made, PersonGate)
        patient = made.gate.gate
        assert isinstance(patient, PatientGate)
        assert patient.config == limits
        assert patient.session
        assert isinstance(patient.gate, GuardedGate)
        assert isinstance(patient.gate.gate, AlwaysPolicy)


def test_with_a_person_there_nobody_is_simulated_beside(cockpit):
    driver = OperatedDriver(Limited(HumanGate(watching(OperatorConfig()))), cockpit)
    gate = driver.crew(CORRIDOR, Corridor()).gate
    gate.reset(np.random.default_rng(0))
    # The expert would do otherwise, and he would say so.
    seen = [Observation({}, np.full(1, 2.0, np.float32), step / 10) for step in range(60)]
    proposed = Proposal(np.zeros((1, 1), np.float32))
    assert {gate.decide(each, proposed).actor for each in seen} == {Actor.POLICY}


def test_a_task_without_teleop_and_an_unknown_fallback_are_refused(cockpit):
    with pytest.raises(ParameterError, match="nobody can drive corridor by hand"):
        OperatedDriver(STRAIGHT, cockpit).crew(replace(CORRIDOR, teleop=None), Corridor())
    with pytest.raises(UnknownNameError, match="drift"):
        OperatedDriver(STRAIGHT, cockpit, fallback="drift").crew(CORRIDOR, Corridor())
