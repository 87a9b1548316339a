"""Where an action would lead in a second, by the environment's own kinematics."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from sheath_manip.protocols import Environment, Restorable, Viewable
from sheath_manip.types import Action, ActionSpec, ScenePose

AHEAD_S = 1.0
MOVED = 1e-4
"""metres, or parts of a unit quaternion, by which a body has moved"""


@runtime_checkable
class Simulation(Environment, Restorable, Viewable, Protocol):
    """An environment that can be looked into, and taken back to any moment."""


@dataclass(frozen=True, eq=False)
class Ghost:
    """A second of an action that is held."""

    way_m: NDArray[np.float64]
    """(n, 3) of the tool, from where it is; (0, 3) where the scene has no tool"""
    pose: ScenePose
    """at its end"""
    bodies: NDArray[np.int64]
    """(b,) rows of the bodies that the action moves"""


def ghosts(
    simulation: Simulation, state: NDArray[np.float64], actions: Sequence[Action]
) -> list[Ghost]:
    """Return what each of `actions` leads to from `state`, at which nothing stands afterwards.

    A body counts as moved by an action where it moves, and would not move so under quite another
    one: traffic moves whatever one does.
    """
    spec = simulation.spec
    steps = max(1, round(AHEAD_S * spec.control_rate_hz))
    ways = [_ahead(simulation, state, action, steps) for action in actions]
    found = []
    for action, way in zip(actions, ways, strict=True):
        other = _ahead(simulation, state, _opposite(spec.action, action), steps)
        last = min(len(way), len(other)) - 1
        apart = _moved(way[last], other[last]) & _moved(way[-1], way[0])
        tools = [pose.tool_m for pose in way if pose.tool_m is not None]
        way_m = np.array(tools) if tools else np.zeros((0, 3))
        found.append(Ghost(way_m, way[-1], np.flatnonzero(apart)))
    return found


def state_after(
    simulation: Simulation, state: NDArray[np.float64], executed: Action
) -> NDArray[np.float64]:
    """Return the state after one more step, as the episode went on."""
    simulation.restore(state)
    simulation.step(executed)
    return simulation.state()


def _ahead(
    simulation: Simulation, state: NDArray[np.float64], action: Action, steps: int
) -> list[ScenePose]:
    """How the scene stands before and after each step, until an end of the task's own."""
    simulation.restore(state)
    poses = [simulation.pose()]
    for _ in range(steps):
        transition = simulation.step(action)
        poses.append(simulation.pose())
        if transition.terminated:
            break
    return poses


def _opposite(spec: ActionSpec, action: Action) -> Action:
    """The bounds farthest from `action`, or of choices the one farthest from it."""
    if spec.choices is not None:
        return spec.choices[int(np.abs(spec.choices - action).sum(axis=1).argmax())]
    middle = (spec.minimum + spec.maximum) / 2
    return np.where(action > middle, spec.minimum, spec.maximum).astype(np.float32)


def _moved(left: ScenePose, right: ScenePose) -> NDArray[np.bool_]:
    return np.any(np.abs(left.bodies - right.bodies) > MOVED, axis=1)
