"""Tells whether a scene can be solved: the expert's law, run through without physics."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.tasks.grasp_clutter.guide import GraspGuide, Situation, rotations_of
from sheath_manip.tasks.grasp_clutter.scene import Scene

_MOST_STEPS = 160
_SQUEEZED_M = 0.02
_LIFTED_M = 0.11


def solvable(guide: GraspGuide, scene: Scene, start_rad: NDArray) -> bool:
    """Return whether the arm gets from (j,) `start_rad` around the scene's target and lifts it.

    Nothing moves but the arm, and what it holds: one that passes never needs to touch the clutter.
    """
    guide.begin(scene)
    positions = np.array([[each.x_m, each.y_m, 0.0] for each in scene.objects])
    halves = np.array([each.yaw_rad / 2 for each in scene.objects])
    wxyz = np.zeros((len(halves), 4))
    wxyz[:, 0], wxyz[:, 3] = np.cos(halves), np.sin(halves)
    rotations = rotations_of(wxyz)
    joints = np.array(start_rad, float)
    closed, pressed = 0.0, 0.0
    for _ in range(_MOST_STEPS):
        situation = Situation(joints, closed, pressed, positions, wxyz, rotations)
        command = guide.wish(situation)
        guide.guard(situation, command)
        moved = guide.guarded.joint_targets(joints, command.twist)
        if pressed:
            control = guide.guarded.control
            before = control.transform_tool_to_world(joints)[:3, 3]
            positions[0] += control.transform_tool_to_world(moved)[:3, 3] - before
            if positions[0, 2] > _LIFTED_M:
                return True
        elif command.arrived == 1.0:
            opening = guide.opening_m
            closed, pressed = opening - 2 * scene.target.half_x_m, _SQUEEZED_M
        elif np.abs(moved - joints).max() < 1e-4:
            return False
        joints = moved
    return False
