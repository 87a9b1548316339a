"""Driving on a closed track among slower cars (the SHEATH draft, section V-B), on dm_control."""

from collections import OrderedDict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import accumulate
from typing import Any

import numpy as np
from dm_control import composer, mjcf
from dm_control.composer.observation import observable
from numpy.typing import NDArray

from sheath_manip.tasks.assets import assets_of
from sheath_manip.tasks.composer_environment import SheathTask
from sheath_manip.tasks.driving.track import Track, picture_png
from sheath_manip.tasks.rendering import PyramidCamera
from sheath_manip.types import ActionSpec, FirstView, Outcome, TaskSpec

ASSETS = assets_of("driving")

CONTROL_TIMESTEP_S = 0.1
SUBSTEPS = 4
"""of the simulator in a control step"""
PHYSICS_TIMESTEP_S = CONTROL_TIMESTEP_S / SUBSTEPS
SPEED_M_S = 10.0
TRAFFIC_SPEED_M_S = 4.0
"""common to all: at mixed speeds the traffic can block the road"""
STEERING_RAD = np.deg2rad(15.0)
"""a turn per control step, the draft's u in {-15, 0, 15} degrees"""
VIEW_M = 26.0
"""edge of the square of ground that the camera sees"""


@dataclass(frozen=True)
class Scenario:
    """A scenario: what a variant of the task may change."""

    laps: float = 1.0
    """after which an episode has succeeded"""
    cars: int = 13
    """besides one's own"""
    render_px: int = 250
    pyramid_levels: int = 1


class CarFrame(composer.Entity):
    """One car; the hull is the only geom that touches anything."""

    _mjcf_root: Any  # mjcf makes its attributes from MuJoCo's schema at run time

    def _build(self, name: str, rgba: tuple[float, float, float, float] | None = None) -> None:
        self._mjcf_root = mjcf.from_path(str(ASSETS / "car.xml"))
        self._mjcf_root.model = name
        if rgba is not None:
            self._mjcf_root.find("geom", "hull").rgba = rgba

    @property
    def mjcf_model(self) -> mjcf.RootElement:
        """The MJCF model."""
        return self._mjcf_root


class DrivingArena(composer.Arena):
    """The ground, with the whole track baked into one texture."""

    _mjcf_root: Any

    def _build(self, track: Track, name: str = "driving") -> None:
        self._mjcf_root = mjcf.from_path(str(ASSETS / "arena.xml"))
        self._mjcf_root.model = name
        texture = self._mjcf_root.asset.add(
            "texture", name="track", type="2d", file=mjcf.Asset(picture_png(track), ".png")
        )
        material = self._mjcf_root.asset.add(
            "material", name="track", texture=texture, texrepeat=[1, 1], texuniform=False
        )
        extent_x, extent_y = track.extent
        self._mjcf_root.worldbody.add(
            "geom",
            name="ground",
            type="plane",
            size=[extent_x, extent_y, 1],
            material=material,
            contype=0,
            conaffinity=0,
        )


class DrivingTask(SheathTask):
    """Drive laps without touching a car or leaving the road.

    The car is the unicycle x = [x y heading] at constant speed: each control step turns it by the
    steering angle and moves it forward. Traffic keeps its lane offset at one common, lower speed.
    """

    def __init__(self, scenario: Scenario | None = None, track: Track | None = None) -> None:
        self.scenario = scenario or Scenario()
        self.track = track or Track()
        self._arena = DrivingArena(self.track)
        self._car = CarFrame("car", rgba=(0.85, 0.15, 0.1, 1.0))
        frame = self._arena.attach(self._car)
        self._joints = [
            frame.add("joint", name="x", type="slide", axis=[1, 0, 0]),
            frame.add("joint", name="y", type="slide", axis=[0, 1, 0]),
            frame.add("joint", name="heading", type="hinge", axis=[0, 0, 1]),
        ]
        self._traffic = []
        for number in range(self.scenario.cars):
            other = self._arena.attach(CarFrame(f"traffic_{number}"))
            other.mocap = "true"
            self._traffic.append(other)
        self._add_cameras()
        self.set_timesteps(control_timestep=CONTROL_TIMESTEP_S, physics_timestep=PHYSICS_TIMESTEP_S)
        self._traffic_start = np.zeros((self.scenario.cars, 2))
        self._coming: Iterator[NDArray[np.float64]] = iter(())
        self._last_s_m = 0.0
        self._driven_m = 0.0
        self._outcome = Outcome.TIME_LIMIT
        lap_steps = self.track.lap_length / (SPEED_M_S * CONTROL_TIMESTEP_S)
        self.spec = TaskSpec(
            name="driving",
            control_rate_hz=1.0 / CONTROL_TIMESTEP_S,
            action=ActionSpec(
                names=("steering_rad",),
                minimum=np.array([-STEERING_RAD], np.float32),
                maximum=np.array([STEERING_RAD], np.float32),
                choices=np.array([[-STEERING_RAD], [0.0], [STEERING_RAD]], np.float32),
                choice_words=("go right", "go straight", "go left"),
            ),
            cameras={"overhead": self._overhead.shape},
            feature_names=("x_m", "y_m", "heading_rad"),
            # Weaving around traffic costs a few per cent; a car that needs 1.5 laps' time is lost.
            max_steps=int(1.5 * self.scenario.laps * lap_steps),
            metric="laps",
            plane=("x_m", "y_m"),
            first_view=FirstView(22.0, azimuth_deg=90.0, elevation_deg=60.0, follows=True),
        )

    def _add_cameras(self) -> None:
        # Above the car and turned with it: image up is the car's forward.
        worldbody: Any = self._car.mjcf_model.worldbody
        worldbody.add(
            "camera",
            name="overhead",
            pos=[0, 0, 30],
            xyaxes=[0, -1, 0, 1, 0, 0],
            projection="orthographic",
            fovy=VIEW_M,
        )
        self._overhead = PyramidCamera(
            "car/overhead", self.scenario.render_px, self.scenario.pyramid_levels
        )
        self._camera_observable = observable.Generic(self._overhead)
        self._pose_observable = observable.Generic(self.pose)
        for item in (self._camera_observable, self._pose_observable):
            item.enabled = True

    def camera_name(self, name: str) -> str:
        """Return the model's name of the camera that observations call `name`."""
        return f"car/{name}"

    @property
    def root_entity(self) -> composer.Entity:
        """The arena."""
        return self._arena

    @property
    def task_observables(self) -> OrderedDict:
        """The overhead camera, and the pose as features."""
        return OrderedDict(overhead=self._camera_observable, pose=self._pose_observable)

    def pose(self, physics: mjcf.Physics) -> NDArray[np.float64]:
        """(3,) x (m), y (m) and heading (rad) of the car in the world frame."""
        return np.array(physics.bind(self._joints).qpos)

    def tool_m(self, physics: mjcf.Physics) -> NDArray[np.float64]:
        """(3,) where the car is."""
        x, y, _ = self.pose(physics)
        return np.array([x, y, 0.5])

    def place(self, physics: mjcf.Physics, pose: NDArray) -> None:
        """Put the car at (3,) x (m), y (m), heading (rad), for tests and for scripted starts."""
        physics.bind(self._joints).qpos = pose
        self._last_s_m = float(self.track.coordinates(pose[0], pose[1])[0])

    def traffic_poses(self, times_s: NDArray) -> NDArray[np.float64]:
        """(..., c, 3) x (m), y (m), heading (rad) of the other cars at `times_s` of the episode."""
        along = self._traffic_start[:, 0] + TRAFFIC_SPEED_M_S * np.asarray(times_s)[..., None]
        return self.track.pose(along, np.broadcast_to(self._traffic_start[:, 1], along.shape))

    @property
    def traffic_start(self) -> NDArray[np.float64]:
        """(c, 2) track coordinates (s, lateral) in metres of the other cars at time 0."""
        return self._traffic_start.copy()

    def set_traffic(self, physics: mjcf.Physics, start: NDArray) -> None:
        """Lay the traffic: (c, 2) track coordinates (s, lateral) in metres at time 0."""
        self._traffic_start = np.array(start, float)
        lay_traffic(physics, self.traffic_poses(np.asarray(physics.time())))

    def initialize_episode(self, physics: mjcf.Physics, random_state) -> None:
        """Draw start and traffic."""
        lap = self.track.lap_length
        cars = self.scenario.cars
        start_s = random_state.uniform(0, lap)
        # The others share the lap behind a free stretch ahead of the start, at least 5 m apart
        # nose to nose, so that there is always a way through.
        free_m, apart_m = 12.0, 5.0
        slack = lap - 2 * free_m - apart_m * (cars - 1)
        offsets = free_m + np.sort(random_state.uniform(0, slack, cars)) + apart_m * np.arange(cars)
        lateral = random_state.uniform(-3.0, 3.0, cars)
        self.set_traffic(physics, np.stack([start_s + offsets, lateral], 1))
        pose = self.track.pose(start_s, random_state.uniform(-1.5, 1.5))
        pose[2] += random_state.uniform(-0.1, 0.1)
        self.place(physics, pose)
        self._driven_m = 0.0
        self._outcome = Outcome.TIME_LIMIT

    def before_step(self, physics: mjcf.Physics, action: NDArray, random_state) -> None:  # noqa: ARG002
        """Turn, then set the velocity of the step."""
        joints = physics.bind(self._joints)
        heading = joints.qpos[2] + float(action[0])
        joints.qpos[2] = heading
        joints.qvel = [SPEED_M_S * np.cos(heading), SPEED_M_S * np.sin(heading), 0.0]
        # All substeps' at once: for so few cars a call costs what it costs for all of them.
        times_s = list(accumulate([PHYSICS_TIMESTEP_S] * SUBSTEPS, initial=physics.time()))
        self._coming = iter(self.traffic_poses(np.array(times_s)))

    def before_substep(self, physics: mjcf.Physics, action: NDArray, random_state) -> None:  # noqa: ARG002
        """Move the traffic."""
        lay_traffic(physics, next(self._coming))

    def after_substep(self, physics: mjcf.Physics, random_state) -> None:  # noqa: ARG002
        """A contact is a crash; only hulls can touch."""
        if physics.data.ncon:
            self._outcome = Outcome.FAILURE

    def after_step(self, physics: mjcf.Physics, random_state) -> None:  # noqa: ARG002
        """Count the way driven, and judge."""
        lay_traffic(physics, next(self._coming))
        # The step's picture is drawn from the kinematics, which knew the traffic's place before.
        physics.forward()
        x, y, _ = self.pose(physics)
        s, lateral, _ = self.track.coordinates(x, y)
        lap = self.track.lap_length
        self._driven_m += float((s - self._last_s_m + lap / 2) % lap - lap / 2)
        self._last_s_m = float(s)
        if abs(lateral) > self.track.road_half_width:
            self._outcome = Outcome.FAILURE
        elif self._outcome is Outcome.TIME_LIMIT and self._driven_m >= self.scenario.laps * lap:
            self._outcome = Outcome.SUCCESS

    def get_reward(self, physics: mjcf.Physics) -> float:  # noqa: ARG002
        """-1 for a failure, 0 otherwise: learning from demonstrations needs no reward."""
        return -1.0 if self._outcome is Outcome.FAILURE else 0.0

    def outcome(self) -> Outcome:
        """FAILURE on contact or off the road, SUCCESS after the scenario's laps."""
        return self._outcome

    def metrics(self) -> Mapping[str, float]:
        """Laps driven, at most the scenario's."""
        laps = self._driven_m / self.track.lap_length
        return {"laps": float(np.clip(laps, 0.0, self.scenario.laps))}

    def memory(self) -> NDArray[np.float64]:
        """(3 + 2c,) last s (m), way driven (m), outcome, traffic."""
        outcome = list(Outcome).index(self._outcome)
        return np.concatenate(
            [[self._last_s_m, self._driven_m, outcome], self._traffic_start.ravel()]
        )

    def recall(self, memory: NDArray[np.float64]) -> None:
        """Take over a `memory()`."""
        self._last_s_m, self._driven_m = float(memory[0]), float(memory[1])
        self._outcome = list(Outcome)[int(memory[2])]
        self._traffic_start = memory[3:].reshape(-1, 2).copy()


def lay_traffic(physics: mjcf.Physics, poses: NDArray[np.float64]) -> None:
    """Put the other cars at (c, 3) x (m), y (m), heading (rad)."""
    data = physics.data
    data.mocap_pos[:, :2] = poses[:, :2]
    half = poses[:, 2] / 2
    data.mocap_quat[:] = 0.0
    data.mocap_quat[:, 0], data.mocap_quat[:, 3] = np.cos(half), np.sin(half)
