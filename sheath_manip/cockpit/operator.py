"""The person at the controls as one who may act, and the others beside it."""

from collections.abc import Mapping

from sheath_manip.cockpit.cockpit import Cockpit
from sheath_manip.protocols import Expert, Teleop
from sheath_manip.types import Action, Actor, Observation


class Operator:
    """Acts as the person does whose devices the cockpit hears."""

    def __init__(self, cockpit: Cockpit, teleop: Teleop) -> None:
        self.cockpit = cockpit
        self.teleop = teleop

    def reset(self) -> None:
        """Let the page see where the tool is."""
        self.cockpit.tool_pose = self.teleop.tool_pose()

    def follow(self, observation: Observation) -> None:
        """Let the page see where the tool is, also while somebody else acts."""
        del observation
        self.cockpit.tool_pose = self.teleop.tool_pose()

    def act(self, observation: Observation) -> Action:
        """(a,) what the person's devices said in this step."""
        del observation
        return self.teleop.action(self.cockpit.input)


def beside_the_policy(
    cockpit: Cockpit, teleop: Teleop, *, hold: Expert, fallback: Expert
) -> Mapping[Actor, Expert]:
    """Return who may act under a `PersonGate`, but for policy and expert.

    Args:
        cockpit: where the person is.
        teleop: turns the person's devices into actions.
        hold: keeps the robot where it is.
        fallback: acts where a person is asked and does not come.
    """
    return {
        Actor.OPERATOR: Operator(cockpit, teleop),
        Actor.HOLD: hold,
        Actor.FALLBACK: fallback,
    }
