"""A command filter whose every limit is checked at every step, for the arm with a jaw."""

import numpy as np
import pytest

from sheath_manip.controllers.command_filter import MALFORMED, Admitted, CommandFilter
from sheath_manip.controllers.speed_cap import from_standing
from sheath_manip.tasks.robots.filtering import command_filter
from sheath_manip.tasks.robots.own_arm import ARM_WITH_JAW

TIMESTEP_S = 0.05
ROUNDING = 1e-9
HOME = np.array(ARM_WITH_JAW.home_rad)
CAN = np.array([[0.5, 0.0, 0.0, 0.03, 0.12]])


class Watched:
    """Checks every limit at every step, from the commanded positions alone."""

    def __init__(self, guard: CommandFilter, start: np.ndarray) -> None:
        self.guard = guard
        guard.reset(start)
        self.targets = start
        self.velocities = self.changes = np.zeros(len(start))

    def step(self, wished: object) -> Admitted:
        guard, joints = self.guard, self.guard.joints
        before, velocities, changes = self.targets, self.velocities, self.changes
        admitted = guard.step(wished)  # pyright: ignore[reportArgumentType]
        self.targets = admitted.targets_rad
        self.velocities = (self.targets - before) / TIMESTEP_S
        self.changes = self.velocities - velocities
        np.testing.assert_allclose(self.velocities, admitted.velocities_rad_s, atol=ROUNDING)
        assert (self.targets >= joints.lower_rad - ROUNDING).all()
        assert (self.targets <= joints.upper_rad + ROUNDING).all()
        assert (np.abs(self.velocities) <= joints.speeds_rad_s + ROUNDING).all()
        assert (np.abs(self.changes) <= guard.stopping.most_change + ROUNDING).all()
        assert (np.abs(self.changes - changes) <= guard.stopping.most_jerk + ROUNDING).all()
        workspace, cap = guard.workspace, guard.speed_cap
        if workspace is not None:
            tool = workspace.tool_position_m(self.targets)
            assert (tool >= workspace.lower_m - ROUNDING).all()
            assert (tool <= workspace.upper_m + ROUNDING).all()
            assert workspace.distance_m(self.targets) >= workspace.clearance_m - ROUNDING
            if cap is not None:
                moved = np.linalg.norm(tool - workspace.tool_position_m(before))
                assert moved / TIMESTEP_S <= cap.most_m_s(tool) + 1e-6
        self.check_report(wished, before, admitted)
        return admitted

    def check_report(self, wished, before, admitted) -> None:
        """A changed command is reported, and an unchanged one is not."""
        acted = [each.limit for each in admitted.limited]
        assert acted == sorted(set(acted))
        assert all(each.by > 0 for each in admitted.limited)
        usable = (
            isinstance(wished, np.ndarray)
            and wished.shape == before.shape
            and bool((np.abs(wished) < 1e300).all())
        )
        assert (MALFORMED in acted) != usable
        if usable:
            changed = np.abs((wished - self.targets) / TIMESTEP_S).max()
            if changed > 1e-8:
                assert acted
            elif changed < 1e-10:
                assert not acted


def names(admitted: Admitted) -> set[str]:
    return {each.limit for each in admitted.limited}


@pytest.fixture(scope="module")
def arm() -> CommandFilter:
    return command_filter(ARM_WITH_JAW, TIMESTEP_S)


@pytest.fixture(scope="module")
def careful_arm() -> CommandFilter:
    """Knows of a can."""
    return command_filter(ARM_WITH_JAW, TIMESTEP_S, from_standing(lambda: CAN))
