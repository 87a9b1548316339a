"""The expert of a run that a person operates: the person, or who acts in the meantime."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sheath_manip.cockpit.cockpit import Cockpit, Turn
from sheath_manip.cockpit.given import Given
from sheath_manip.cockpit.guide import Binding
from sheath_manip.protocols import Expert, Follows, TakesOver
from sheath_manip.types import Action, Observation


class Hands(Protocol):
    """Turns what a person's devices say into the actions of one task."""

    @property
    def guide(self) -> tuple[Binding, ...]:
        """Which keys it knows."""
        ...

    @property
    def dead_man(self) -> bool:
        """Whether the robot holds while no device is held; else to hold none is an action."""
        ...

    def action(self, given: Given) -> Action:
        """(a,) within the task's bounds, whatever the devices say."""
        ...

    def tool_pose(self) -> NDArray[np.float64] | None:
        """(7,) position (m) and wxyz quaternion of what a gizmo moves, None where nothing is."""
        ...


class OperatedExpert:
    """Acts as whoever the gate gave the turn to: the person, standing still, or the fallback."""

    def __init__(
        self, cockpit: Cockpit, hands: Hands, fallback: Expert, hold: Expert | None = None
    ) -> None:
        """`hold` leaves the robot where it is; without one the fallback acts in its place."""
        self.cockpit = cockpit
        self.hands = hands
        self.fallback = fallback
        self.hold = fallback if hold is None else hold
        self._turn = Turn.POLICY

    def reset(self) -> None:
        """A new episode for all of them."""
        self._turn = Turn.POLICY
        for expert in (self.fallback, self.hold):
            expert.reset()
        self.cockpit.tool_pose = self.hands.tool_pose()

    def follow(self, observation: Observation) -> None:
        """Let the stand-ins see where the robot goes, and the page where the tool is."""
        for expert in (self.fallback, self.hold):
            if isinstance(expert, Follows):
                expert.follow(observation)
        self.cockpit.tool_pose = self.hands.tool_pose()

    def take_over(self, observation: Observation) -> None:  # noqa: ARG002
        """Whoever acts next begins its turn."""
        self._turn = Turn.POLICY

    def act(self, observation: Observation) -> Action:
        """(a,) of whose turn it is."""
        before, self._turn = self._turn, self.cockpit.turn
        begins = self._turn is not before
        if self._turn is Turn.PERSON:
            return self.hands.action(self.cockpit.given)
        expert = self.hold if self._turn is Turn.HOLD else self.fallback
        if begins and isinstance(expert, TakesOver):
            expert.take_over(observation)
        return expert.act(observation)
