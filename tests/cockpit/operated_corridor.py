"""A person's page on the toy task: it orders at given steps, and time passes with them."""

from collections.abc import Callable, Mapping

import numpy as np

from sheath_manip.cockpit import (
    Cockpit,
    OperatedEnvironment,
    OperatorInput,
    Order,
    PersonGate,
    beside_the_policy,
)
from sheath_manip.gates import SupportGate
from sheath_manip.gates.patient import RequestConfig
from sheath_manip.protocols import Gate
from sheath_manip.rollout.discarding import until_kept
from sheath_manip.rollout.loop import rollout
from sheath_manip.types import Actor, Episode, EpisodeInfo, Observation, Purpose, Reason
from tests.cockpit.clock import Clock
from tests.judging import ByObservation
from tests.toy import Corridor, MiddleKeeper, hold, teleop
from tools.scripted_person import Absent

INFO = EpisodeInfo("corridor", 3, Purpose.LEARNING, 50.0)
PERIOD_S = 1 / 50.0
LEFT, IDLE = OperatorInput(keys=frozenset({"KeyJ"})), OperatorInput()
Script = Mapping[int, Callable[[Cockpit], object]]
"""by the number of steps done, what is done at the page then"""
AS_ON_A_ROBOT = {"dead_man": True, "stands_still": False, "requests": RequestConfig()}
"""held step by step while it waits, and asking at each alarm"""
STRAIGHT = Absent(lambda: np.zeros(1, np.float32))


class Page:
    """A listener that plays the page, and lets time pass."""

    def __init__(self, cockpit: Cockpit, clock: Clock, script: Script) -> None:
        self.cockpit, self.clock, self.script = cockpit, clock, script
        self.steps = 0
        self.turns: list[Actor] = []

    def on_fit(self, states) -> None:
        del states

    def on_start(self, environment, info) -> None:
        del environment, info
        self.steps = 0
        self._play()

    def on_step(self, environment, step) -> None:
        del environment
        self.steps += 1
        # A bare gate knows of no person, so its environment stands still instead.
        assert step.decision.actor is self.cockpit.turn or not self.cockpit.gated
        self.turns.append(step.decision.actor)
        self.clock.s += PERIOD_S
        self._play()

    def on_end(self, episode) -> None:
        del episode

    def _play(self) -> None:
        self.script.get(self.steps, lambda _: None)(self.cockpit)


def outside_between(first: int, last: int) -> Gate:
    """A support gate that is outside in those steps."""

    def score(observation: Observation) -> float:
        return -1.0 if first <= observation.features[1] < last else 1.0

    return SupportGate(ByObservation(score), 0.0)


def run(
    script: Script,
    gate: Gate,
    steps: int = 12,
    listeners=(),
    fallback=None,
    held_by_loop: bool = False,
    undo_s: float = 0.0,
    **options,
) -> tuple[Episode, Page]:
    clock = Clock()
    cockpit = Cockpit(teleop(Corridor()).guide, clock, undo_s=undo_s)
    environment = Corridor(steps)
    others = beside_the_policy(
        cockpit,
        teleop(environment),
        hold=hold(environment),
        fallback=MiddleKeeper(environment) if fallback is None else fallback,
    )
    page = Page(cockpit, clock, script)
    episode = until_kept(
        lambda *, rng: rollout(
            OperatedEnvironment(environment, cockpit),
            INFO,
            PersonGate(gate, cockpit, 50.0, **AS_ON_A_ROBOT | options),
            rng=rng,
            policy=STRAIGHT,
            others=others,
            hold=hold(environment) if held_by_loop else None,
            listeners=(*listeners, page),
        ),
        INFO,
        lambda _: None,
    )
    return episode, page


def reasons(episode: Episode) -> list[Reason]:
    return [step.decision.reason for step in episode.steps]


def take(cockpit: Cockpit, given: OperatorInput = LEFT) -> None:
    assert cockpit.order(Order.TAKE_OVER, "page")
    cockpit.submit_input("page", given)
