"""The expert of a run that a person operates: the person, or who acts in the meantime."""

from collections.abc import Mapping
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sheath_manip.cockpit.cockpit import Cockpit
from sheath_manip.cockpit.given import Given
from sheath_manip.cockpit.guide import Binding
from sheath_manip.cockpit.state import Turn
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

    @property
    def planar(self) -> bool:
        """Whether what a gizmo moves stays level and at its height."""
        ...

    def action(self, given: Given) -> Action:
        """(a,) within the task's bounds, whatever the devices say."""
        ...

    def tool_pose(self) -> NDArray[np.float64] | None:
        """(7,) position (m) and wxyz quaternion of what a gizmo moves, None where nothing is."""
        ...


class OperatedExpert:
    """Acts as the gate gave the turn: as the person, or as who stands in for it."""

    def __init__(self, cockpit: Cockpit, hands: Hands, stand_ins: Mapping[Turn, Expert]) -> None:
        """Store who acts in each turn but the person's.

        `stand_ins` has `Turn.HOLD`, who leaves the robot where it is, `Turn.FALLBACK`, who acts
        where no person comes, and `Turn.POLICY`, who acts under a gate that knows no person.
        """
        self.cockpit = cockpit
        self.hands = hands
        self.stand_ins = dict(stand_ins)
        self._turn: Turn | None = None

    def reset(self) -> None:
        """A new episode for all of them."""
        self._turn = None
        for expert in self._experts():
            expert.reset()
        self.cockpit.tool_pose = self.hands.tool_pose()

    def follow(self, observation: Observation) -> None:
        """Let the stand-ins see where the robot goes, and the page where the tool is."""
        for expert in self._experts():
            if isinstance(expert, Follows):
                expert.follow(observation)
        self.cockpit.tool_pose = self.hands.tool_pose()

    def take_over(self, observation: Observation) -> None:  # noqa: ARG002
        """Who acts next begins its turn."""
        self._turn = None

    def act(self, observation: Observation) -> Action:
        """(a,) of whose turn it is."""
        before, self._turn = self._turn, self.cockpit.turn
        if self._turn is Turn.PERSON:
            return self.hands.action(self.cockpit.given)
        expert = self.stand_ins[self._turn]
        if self._turn is not before and isinstance(expert, TakesOver):
            expert.take_over(observation)
        return expert.act(observation)

    def _experts(self) -> list[Expert]:
        """Each of them once."""
        return list({id(expert): expert for expert in self.stand_ins.values()}.values())
