"""The scene of the driving task: the other cars, the camera, and what can be put where."""

import numpy as np

from sheath_manip.gates import AlwaysExpert
from sheath_manip.rollout.loop import rollout
from sheath_manip.tasks.driving.entry import DRIVING
from sheath_manip.tasks.driving.expert import DrivingExpert
from sheath_manip.tasks.driving.task import Scenario
from sheath_manip.types import EpisodeInfo, Outcome, Purpose
from tests.tasks.driven_road import Road, empty, road, small

__all__ = ["empty", "road", "small"]


def traffic_of(road: Road, seed: int) -> np.ndarray:
    """(c, 2) track coordinates of the other cars at the start, s from one's own."""
    seen = road.environment.reset(seed)
    track = road.task.track
    own, _, _ = track.coordinates(seen.features[0], seen.features[1])
    poses = road.task.traffic_poses(np.array(0.0))
    s, lateral, _ = track.coordinates(poses[:, 0], poses[:, 1])
    return np.stack([np.mod(s - own, track.lap_length), lateral], 1)


def test_traffic_and_start_differ_by_seed_and_leave_room(road):
    scenes = {seed: traffic_of(road, seed) for seed in range(40)}
    starts = {seed: road.environment.reset(seed).features for seed in range(3)}
    assert not np.allclose(scenes[0], scenes[1])
    assert not np.allclose(starts[0], starts[1])
    for traffic in scenes.values():
        s = np.sort(traffic[:, 0])
        assert s[0] > 10
        assert s[-1] < road.task.track.lap_length - 10
        # Nose to nose; 2 m of it are a car.
        assert np.diff(s).min() > 4.9
        assert np.abs(traffic[:, 1]).max() < road.task.track.road_half_width - 0.5


def test_the_traffic_keeps_its_distances(road):
    road.environment.reset(4)
    track = road.task.track
    s, lateral, _ = track.coordinates(
        *np.moveaxis(road.task.traffic_poses(np.array([0, 9.0])), -1, 0)[:2]
    )
    moved = np.mod(s[1] - s[0], track.lap_length)
    np.testing.assert_allclose(moved, moved[0], atol=1e-6)
    np.testing.assert_allclose(lateral[0], lateral[1], atol=1e-6)


def test_the_papers_camera_shows_the_same(road):
    paper = DRIVING.make("paper-camera")
    for seed in (3, 8):
        fine = paper.reset(seed).images["overhead"]
        default = road.environment.reset(seed).images["overhead"]
        assert fine.shape == default.shape == (125, 125, 3)
        assert np.abs(fine.astype(float) - default).mean() < 2.0
    paper.close()


def test_the_camera_turns_with_the_car(road):
    views = []
    for s in (0.0, road.task.track.half_length - road.task.track.corner_radius + 1.0):
        road.put(s, 0.0)
        views.append(road.environment.observe().images["overhead"].astype(float))
    straight, corner = views
    # The tail of the red car, a little below the middle; straight ahead of it lies tarmac.
    red, green, blue = straight[66, 62]
    assert red > 2 * max(green, blue)
    ahead = straight[10, 50:75].mean(0)
    assert np.ptp(ahead) < 40
    # Where the road bends to the left, there is grass ahead.
    far_ahead = corner[4, 66:90].mean(0)
    assert np.argmax(far_ahead) == 1
    assert far_ahead[1] > far_ahead[2] + 20


def test_place_and_set_traffic(small):
    small.environment.reset(0)
    physics = small.environment.physics
    small.task.place(physics, np.array([3.0, -15.0, 0.2]))
    np.testing.assert_array_equal(small.task.pose(physics), [3.0, -15.0, 0.2])
    start = np.array([[10.0, 1.0], [50.0, -2.0], [90.0, 0.0]])
    small.task.set_traffic(physics, start)
    expected = small.task.track.pose(start[:, 0], start[:, 1])
    np.testing.assert_allclose(small.task.traffic_poses(np.array(0.0)), expected)
    physics.forward()
    shown = small.environment.pose().bodies
    for pose in expected:
        assert np.hypot(*(shown[:, :2] - pose[:2]).T).min() < 1e-9


def test_a_scene_without_other_cars_can_be_driven(empty):
    info = EpisodeInfo("driving", 2, Purpose.DEMONSTRATION, 10.0)
    empty.task.scenario = Scenario(laps=0.2, cars=0)
    try:
        episode = rollout(
            empty.environment,
            info,
            AlwaysExpert(),
            rng=np.random.default_rng(0),
            expert=DrivingExpert(empty.environment),
        )
    finally:
        empty.task.scenario = Scenario(laps=3.0, cars=0)
    assert episode.outcome is Outcome.SUCCESS
