"""What the gates of the grasp in clutter are tested with."""

import numpy as np
import pytest

from sheath_manip.tasks.grasp_clutter.entry import GRASP_CLUTTER
from sheath_manip.tasks.grasp_clutter.study.probes import COSTLY_LEAN, PROBES


@pytest.fixture(scope="module")
def table():
    environment = GRASP_CLUTTER.make("medium")
    yield environment
    environment.close()


def driven(table, seed: int, steps: int):
    """The expert after so many steps."""
    expert = GRASP_CLUTTER.expert(table)
    observation = table.reset(seed)
    expert.reset()
    for _ in range(steps):
        observation = table.step(expert.act(observation)).observation
    return expert, observation


@pytest.mark.parametrize("displacement", PROBES.displacements, ids=lambda d: d.name)
def test_a_displacement_is_where_its_name_says_and_is_undone_by_restoring(table, displacement):
    _, before = driven(table, 3, steps=20)
    state, drive = table.state(), table.task.drive
    closed_m = drive.closed_m()
    # Where the arm is, which its servos' targets are ahead of.
    pose = drive.control.transform_tool_to_world(drive.positions_rad())
    seen = displacement.apply(table, np.random.default_rng(0))
    assert not np.array_equal(seen.images["wrist"], before.images["wrist"])
    now = drive.control.transform_tool_to_world(drive.positions_rad())
    moved_m = np.linalg.norm(now[:3, 3] - pose[:3, 3])
    turn = now[:3, :3] @ pose[:3, :3].T
    turned_deg = np.rad2deg(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1)))
    kind, value, *_ = displacement.name.split()
    aside = float(value) / 100 if kind == "aside" else 0.0
    angle = float(value.rstrip("°")) if kind in ("turned", "tilted") else 0.0
    assert moved_m == pytest.approx(aside, abs=2e-3)
    assert turned_deg == pytest.approx(angle, abs=1.0)
    assert (drive.closed_m() > closed_m + 0.02) == (kind == "jaw")
    after = table.restore(state)
    np.testing.assert_array_equal(after.images["wrist"], before.images["wrist"])
    np.testing.assert_array_equal(table.state(), state)


def test_the_experts_own_action_pushes_nothing_and_one_through_the_clutter_does(table):
    expert, observation = driven(table, 4, steps=40)
    state = table.state()
    assert PROBES.regret(expert, expert.act(observation)) < COSTLY_LEAN / 3
    np.testing.assert_array_equal(table.state(), state)
    sideways = np.array([[x, y, 0, 0, 0, 0, -1] for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1))])
    worst = max(PROBES.regret(expert, action) for action in sideways.astype(np.float32))
    assert worst > COSTLY_LEAN
