"""A person that is a program: it looks at the robot, and drives by the page's own websocket alone.

What it does it has from the task's scripted expert, put into what a person has in its hands: the
two sticks and the buttons of a gamepad for an arm, two keys for a car, four for a blade in a plane.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from sheath_manip.cockpit import Cockpit
from sheath_manip.controllers.teleop.gamepad import DEAD_ZONE
from sheath_manip.controllers.teleop.keys import SPEED as KEY_SPEED
from sheath_manip.policies.memoryless import Memoryless
from sheath_manip.protocols import Environment, Expert
from sheath_manip.types import Action, Episode, EpisodeInfo, Observations, Proposal, Step
from sheath_manip.types.operator_input import DEAD_MAN_BUTTON, Gamepad
from tools.station import TIMEOUT_S, Station


@dataclass(frozen=True)
class Held:
    """What is in its hands."""

    keys: frozenset[str] = frozenset()
    axes: tuple[float, float, float, float] | None = None
    buttons: frozenset[int] = frozenset()


@dataclass
class ScriptedPerson:
    """A listener: after each step it looks, thinks, and has the server know what it holds.

    So it keeps step with a loop that runs as fast as it can. It takes over when it is asked, and
    does not hand back.
    """

    station: Station
    expert: Expert
    hands: Callable[[Action], Held]
    cockpit: Cockpit
    """to see when the server has heard; it is never spoken to"""
    took_over: int = field(default=0, init=False)

    def on_fit(self, states) -> None:
        """It learns nothing."""

    def on_start(self, environment: Environment, info: EpisodeInfo) -> None:
        """Get ready."""
        del environment, info
        self.expert.reset()
        if self.cockpit.state.taken:
            self._get_hold()

    def on_step(self, environment: Environment, step: Step) -> None:
        """Act on what there is to be seen now."""
        del environment
        if self.cockpit.state.asking and not self.cockpit.state.taken:
            self.took_over += 1
            self.station.order("take-over")
            self._until(lambda: self.cockpit.lease.holder is not None)
            self._get_hold()
        # The expert looks at the physics; an observation of the step before is only its form.
        self._hold(self.hands(self.expert.act(step.observation)))

    def on_end(self, episode: Episode) -> None:
        """Nothing more to do."""

    def _get_hold(self) -> None:
        """Begin a turn by any key; it is let go of before the loop looks."""
        self._hold(Held(keys=frozenset(self.cockpit.guide[0].codes[:1])))

    def _hold(self, held: Held) -> None:
        self.station.hold(held.keys, held.axes, held.buttons)
        pad = None if held.axes is None else Gamepad(held.axes, held.buttons)
        self._until(lambda: self._heard(held.keys, pad))

    def _heard(self, keys: frozenset[str], pad: Gamepad | None) -> bool:
        operator_input = self.cockpit.latest_input
        return self.cockpit.lease.holder is None or (
            operator_input.keys == keys and operator_input.pad == pad
        )

    def _until(self, condition: Callable[[], bool]) -> None:
        deadline_s = time.monotonic() + TIMEOUT_S
        while not condition():
            if time.monotonic() > deadline_s:
                raise TimeoutError("the server has not heard the scripted person")
            time.sleep(0.001)


def at_the_wheel(action: Action) -> Held:
    """The key that steers so; straight on has one too, by which a turn begins without a swerve."""
    if action[0] == 0:
        return Held(keys=frozenset({"KeyK"}))
    return Held(keys=frozenset({"KeyJ" if action[0] > 0 else "KeyL"}))


def on_four_keys(action: Action) -> Held:
    """The keys that move a tool in a plane so, in one of eight directions."""
    x, y = (float(each) for each in action)
    asked = {"KeyI": x, "KeyK": -x, "KeyJ": y, "KeyL": -y}
    return Held(keys=frozenset(key for key, share in asked.items() if share > KEY_SPEED / 2))


def on_the_sticks(action: Action) -> Held:
    """A gamepad that moves an arm so, as far as two sticks can: it stays as tilted as it is."""
    x, y, z, _, _, turn = (float(each) for each in action[:6])
    buttons = {DEAD_MAN_BUTTON}
    if abs(action[6]) > 0.5:
        buttons.add(0 if action[6] > 0 else 1)
    axes = tuple(_pushed(each) for each in (-y, -x, -turn, -z))
    return Held(axes=axes, buttons=frozenset(buttons))  # pyright: ignore[reportArgumentType]


def _pushed(share: float) -> float:
    """How far to push a stick for a share of the fastest."""
    if abs(share) < 1e-3:
        return 0.0
    return float(np.clip(np.copysign(DEAD_ZONE + (1 - DEAD_ZONE) * abs(share), share), -1.0, 1.0))


class Absent(Memoryless):
    """A policy that does nothing, so that somebody must come."""

    def __init__(self, rest: Callable[[], Action]) -> None:
        self.rest = rest

    def predict(self, observations: Observations) -> Proposal:
        """Propose to rest, whatever is observed."""
        return Proposal(np.tile(self.rest(), (len(observations), 1)))
