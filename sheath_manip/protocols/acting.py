"""What those must offer who may act: experts, operators, policies."""

from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from sheath_manip.types import Action, Observation, Observations, Proposal
from sheath_manip.types.operator_input import Binding, OperatorInput


class Expert(Protocol):
    """Knows what to do from any state; may look at the physics, given in its constructor."""

    def reset(self) -> None:
        """Forget the last episode; called after the environment's reset."""
        ...

    def act(self, observation: Observation) -> Action:
        """(a,) what the expert would do now. Asked at most once a step."""
        ...


@runtime_checkable
class TakesOver(Expert, Protocol):
    """An expert that keeps a pose of its own, such as a person's device, and must not jump."""

    def take_over(self, observation: Observation) -> None:
        """Start from the present state: called at each change to the expert, before it is asked."""
        ...


@runtime_checkable
class Follows(Protocol):
    """An expert that must know the way travelled, or a policy that looks at the physics."""

    def follow(self, observation: Observation) -> None:
        """Look at the state at each step, before anyone acts."""
        ...


class Teleop(Protocol):
    """Turn what a person's devices say into the actions of one task."""

    @property
    def guide(self) -> tuple[Binding, ...]:
        """The keys that the device knows."""
        ...

    @property
    def dead_man(self) -> bool:
        """Whether the robot holds while no device is held; else to hold none is an action."""
        ...

    @property
    def planar(self) -> bool:
        """Whether what a gizmo moves stays level and at its height."""
        ...

    def action(self, operator_input: OperatorInput) -> Action:
        """(a,) within the task's bounds, whatever the devices say."""
        ...

    def tool_pose(self) -> NDArray[np.float64] | None:
        """(7,) position (m) and wxyz quaternion of what a gizmo moves, None where nothing is."""
        ...


class Policy(Protocol):
    """Proposes actions from what is observed: all that it takes to drive under a gate."""

    def reset(self, rng: np.random.Generator) -> None:
        """Begin an episode: forget the last one, and draw from `rng` from now on."""
        ...

    def propose(self, observations: Observations) -> Proposal:
        """Look once at the present observation (a batch of one), and propose.

        Called once a control step. What an embedding takes of the look goes along as latents, so
        that the gate judges this very proposal and no network sees an image twice.
        """
        ...


@runtime_checkable
class Replans(Protocol):
    """A policy that plans several steps at once, such as a chunk of actions, and acts on the plan.

    A plan of before somebody else acted is for a state that never came.
    """

    def replan(self) -> None:
        """Forget the plan: the last action was not its own. Called before the next `propose`."""
        ...


@runtime_checkable
class HasOwnFrame(Protocol):
    """A policy that sees and acts in a frame of its own, in which alone actions compare."""

    def in_own_frame(self, actions: NDArray, features: NDArray) -> NDArray[np.float32]:
        """(n, a) `actions` of the task, in the frame that (n, f) `features` say."""
        ...
