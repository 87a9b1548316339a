"""Gauze cutting by itself: scenes, what ends an episode, what is remembered and put back."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from sheath_manip.tasks.gauze_cutting.geometry import CLIP_OF_VERTEX, CORNERS_M, MESH, RADIUS_M
from sheath_manip.tasks.gauze_cutting.resting import clip_response
from sheath_manip.tasks.gauze_cutting.scene import DEFAULT, NOMINAL, Slip, draw_scene
from sheath_manip.tasks.gauze_cutting.tally import STRAY_M, TEARING
from sheath_manip.tasks.gauze_cutting.task import DEPTH_M
from sheath_manip.types import Outcome
from tests.tasks.gauze_bench import SEED, bench

__all__ = ["bench"]


def test_scenes_differ_in_all_that_is_drawn():
    scenes = [draw_scene(np.random.default_rng(seed), DEFAULT) for seed in range(40)]
    for values in (
        [scene.centre_m[0] for scene in scenes],
        [scene.yaw_rad for scene in scenes],
        [scene.clips_m[2, 1] for scene in scenes],
        [scene.sag_m for scene in scenes],
        [scene.stiffness for scene in scenes],
        [scene.drag_n for scene in scenes],
        [scene.start_rad for scene in scenes],
        [scene.slips[0].start_s for scene in scenes],
    ):
        assert np.ptp(values) > 0.5 * np.ptp(sorted(values)[1:-1]) > 0
    assert {len(slip.clips) for scene in scenes for slip in scene.slips} == {1, 4}
    assert np.std([scene.clips_m.mean() for scene in scenes]) < DEFAULT.clip_m


def test_a_slip_moves_its_clips_and_no_other():
    slip = Slip(clips=(1,), way_m=(0.003, -0.002), start_s=1.0, duration_s=0.5)
    scene = replace(draw_scene(np.random.default_rng(0), NOMINAL), slips=(slip,))
    before, during, after = (scene.clip_positions_m(time) for time in (0.9, 1.2, 2.0))
    np.testing.assert_allclose(after[1] - before[1], [0.003, -0.002, 0], atol=1e-12)
    np.testing.assert_array_equal(after[[0, 2, 3]], before[[0, 2, 3]])
    assert 0 < during[1, 0] - before[1, 0] < 0.003


def test_what_lies_between_the_clips_goes_along_with_them():
    response = clip_response()
    pushed = np.tile([0.002, -0.001], (4, 1))
    moved = np.einsum("nicj,cj->ni", response, pushed)
    np.testing.assert_allclose(moved, np.tile(pushed[0], (len(moved), 1)), atol=1e-12)
    # To first order a turn is a displacement across.
    turned = 0.01 * np.column_stack([-CORNERS_M[:, 1], CORNERS_M[:, 0]])
    moved = np.einsum("nicj,cj->ni", response, turned)
    wanted = 0.01 * np.column_stack([-MESH.points_m[:, 1], MESH.points_m[:, 0]])
    free = CLIP_OF_VERTEX < 0
    # But clips do not turn, so that what is next to them is sheared.
    inner = np.linalg.norm(MESH.points_m, axis=1) < RADIUS_M
    assert np.abs(moved - wanted)[free].max() < 3e-4
    assert np.abs(moved - wanted)[inner].max() < 5e-5


def test_the_sheet_lies_where_the_scene_has_it_and_hangs_in_its_clips(bench):
    bench.environment.reset(SEED)
    scene, lie = bench.task.scene, bench.task.workpiece.lie()
    held = bench.task.workpiece.sheet.pinned
    clips = scene.clip_positions_m(0.0)
    for corner, clip in zip(CORNERS_M, clips, strict=True):
        np.testing.assert_allclose(lie.of(corner).world_m, clip, atol=1e-6)
    assert lie.of(np.zeros(2)).world_m[2] == pytest.approx(0.15 - scene.sag_m, abs=1e-4)
    before = lie.positions_m.copy()
    bench.steps(10, np.zeros(2, np.float32))
    after = bench.task.workpiece.lie().positions_m
    np.testing.assert_allclose(after[held], before[held], atol=1e-12)
    # It is laid near to where it comes to rest, around the circle at least.
    inner = np.flatnonzero(np.linalg.norm(MESH.points_m, axis=1) < 1.2 * RADIUS_M)
    assert np.abs(after - before)[inner].max() < 7e-4


def test_the_blade_starts_on_the_line_and_below_the_sheet(bench):
    for seed in range(SEED, SEED + 5):
        bench.environment.reset(seed)
        task = bench.task
        place = task.knife.place(task.workpiece.lie(), task.tip_m)
        assert np.linalg.norm(place.material_m) == pytest.approx(RADIUS_M, abs=6e-4)
        assert task.tip_m[2] == pytest.approx(0.15 - DEPTH_M, abs=1e-4)
        assert place.world_m[2] > task.tip_m[2] + 0.003


def test_a_stray_cut_ends_the_episode_as_a_failure(bench):
    bench.environment.reset(SEED)
    outwards = bench.task.scene.rotation @ (bench.task.knife.path_m[0] / RADIUS_M)
    bench.steps(40, outwards.astype(np.float32))
    assert bench.environment.outcome() is Outcome.FAILURE
    largest = bench.environment.metrics()["largest_deviation_mm"]
    assert 1e3 * STRAY_M < largest < 1e3 * STRAY_M + 2
    assert bench.environment.metrics()["freed"] == 0


def test_a_sheet_that_is_strained_too_far_tears(bench):
    bench.environment.reset(SEED)
    pulled = replace(
        bench.task.scene, slips=(Slip((0,), (-0.03, -0.03), start_s=0.0, duration_s=1.0),)
    )
    bench.task.lay(pulled)
    bench.steps(20, np.zeros(2, np.float32))
    assert bench.environment.outcome() is Outcome.FAILURE
    assert bench.environment.metrics()["strain"] > TEARING


def test_without_spares_the_episode_ends_as_a_failure(bench):
    bench.environment.reset(SEED)
    sheet = bench.task.workpiece.sheet
    while sheet.spare_vertices > 8:
        sheet.take_vertex()
    bench.steps(100)
    metrics = bench.environment.metrics()
    assert bench.environment.outcome() is Outcome.FAILURE
    assert (metrics["spares_exhausted"], metrics["freed"]) == (1, 0)
    assert np.isfinite(bench.data.qpos).all()
    # The next episode has them all again.
    bench.environment.reset(SEED)
    assert bench.environment.metrics()["spares_exhausted"] == 0
    assert sheet.spare_vertices == 3 * 24


@pytest.mark.soak
def test_a_cut_out_disc_falls_and_everything_is_put_back(bench):
    bench.environment.reset(SEED)
    names = [n for n in dir(bench.model) if n.startswith(("flex", "jnt_", "body_", "qpos_"))]
    before = {name: np.array(getattr(bench.model, name)) for name in names}
    state = bench.environment.state()
    bench.steps(300)
    assert bench.environment.outcome() is Outcome.SUCCESS
    assert bench.environment.metrics()["iou"] > 0.97
    assert bench.environment.metrics()["stray_pieces"] == 0
    disc = bench.task.workpiece.disc()
    assert disc is not None
    vertices = np.unique(bench.task.workpiece.sheet.elements[disc])
    heights = bench.task.workpiece.lie().positions_m[vertices, 2]
    mujoco.mj_step(bench.model, bench.data, 15)
    mujoco.mj_kinematics(bench.model, bench.data)
    fallen = heights - bench.task.workpiece.lie().positions_m[vertices, 2]
    assert fallen.min() > 0.03
    bench.environment.reset(SEED)
    np.testing.assert_array_equal(bench.environment.state(), state)
    for name, array in before.items():
        np.testing.assert_array_equal(getattr(bench.model, name), array, err_msg=name)


def test_a_half_cut_sheet_is_restored_to_the_bit(bench):
    bench.environment.reset(SEED)
    bench.steps(60)
    state, cuts = bench.environment.state(), bench.task.knife.crack.cuts
    elements = bench.task.workpiece.sheet.elements.copy()
    bench.steps(15)
    end = bench.environment.state()
    bench.environment.reset(SEED)
    bench.environment.restore(state)
    assert bench.task.knife.crack.cuts == cuts
    np.testing.assert_array_equal(bench.task.workpiece.sheet.elements, elements)
    np.testing.assert_array_equal(bench.environment.state(), state)
    bench.steps(15)
    np.testing.assert_array_equal(bench.environment.state(), end)
