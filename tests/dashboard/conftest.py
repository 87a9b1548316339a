"""A task without a simulator: a car, and a stack of shapes, on a picture of a ring road."""

import time
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Locator, Page

from sheath_manip.dashboard import Dashboard
from sheath_manip.protocols import Environment, Restorable
from sheath_manip.types import (
    ActionSpec,
    Actor,
    Episode,
    EpisodeInfo,
    GateDecision,
    Observation,
    Outcome,
    Purpose,
    Reason,
    SceneGeom,
    ScenePose,
    Step,
    TaskSpec,
    Transition,
)
from sheath_manip.types.samples import Samples
from tests.browser import browser_page

__all__ = ["browser_page"]
TOKEN = "a-token-for-tests"
EXTENT_M = 40.0
ROAD_M = np.array([28.0, 18.0])

SPEC = TaskSpec(
    name="ring <b>road</b>",
    control_rate_hz=20.0,
    action=ActionSpec(("steering_rad",), np.array([-1.0], np.float32), np.array([1.0], np.float32)),
    cameras={"front": (48, 96)},
    feature_names=("speed_m_per_s", "x_m", "y_m"),
    max_steps=250,
    metric="laps",
    plane=("x_m", "y_m"),
)


def road_at(angle_rad: NDArray) -> NDArray[np.float64]:
    """(n, 2) metres on the road's centre line."""
    return np.stack([np.cos(angle_rad), np.sin(angle_rad)], -1) * ROAD_M


def ground() -> NDArray[np.uint8]:
    """Green, with a grey road, a red square at +x +y and a blue one at -x +y."""
    pixels = np.full((512, 512, 3), (104, 150, 90), np.uint8)
    scale = 512 / (2 * EXTENT_M)
    axes = (round(ROAD_M[0] * scale), round(ROAD_M[1] * scale))
    cv2.ellipse(pixels, (256, 256), axes, 0, 0, 360, (96, 98, 102), round(9 * scale))
    cv2.ellipse(pixels, (256, 256), axes, 0, 0, 360, (235, 235, 235), 1)
    pixels[20:60, 452:492] = (200, 40, 40)
    pixels[20:60, 20:60] = (40, 60, 200)
    return pixels


def geom(body: int, shape: str, size: Any, rgb: Any, z_m: float = 0.0, **rest: Any) -> SceneGeom:
    return SceneGeom(
        body,
        shape,
        np.asarray(size, float),
        (*rgb, 1.0),
        np.array([0.0, 0.0, z_m]),
        np.array([1.0, 0.0, 0.0, 0.0]),
        **rest,
    )


class RingRoad:
    """Drives around the ring by itself; the state is the angle."""

    spec = SPEC

    def __init__(self) -> None:
        self.angle_rad = 0.0
        tent = np.array([(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0), (0, 0, 4)], np.float32)
        sides = np.array([(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)], np.int32)
        self._scene = [
            geom(0, "picture", (EXTENT_M, EXTENT_M, 0), (1, 1, 1), picture=ground()),
            geom(1, "box", (2.2, 1.0, 0.5), (0.85, 0.2, 0.15), 0.8),
            geom(1, "box", (1.0, 0.9, 0.4), (0.95, 0.95, 0.95), 1.7),
            geom(2, "capsule", (1, 2, 0), (0.2, 0.5, 0.8), 3),
            geom(3, "cylinder", (1.5, 2, 0), (0.9, 0.7, 0.2), 2),
            geom(4, "ellipsoid", (3, 2, 1.5), (0.5, 0.3, 0.7), 1.5),
            geom(5, "sphere", (1.5, 0, 0), (0.2, 0.6, 0.4), 1.5),
            geom(6, "mesh", (1, 1, 1), (0.8, 0.4, 0.5), vertices=tent, faces=sides),
        ]

    def reset(self, seed: int) -> Observation:
        self.angle_rad = float(seed)
        return self._observation()

    def step(self, action: NDArray[np.float32]) -> Transition:
        del action
        self.angle_rad += 0.03
        return Transition(self._observation(), 0.0, False, False)

    def outcome(self) -> Outcome:
        return Outcome.TIME_LIMIT

    def metrics(self) -> Mapping[str, float]:
        return {"laps": self.angle_rad / (2 * np.pi)}

    def state(self) -> NDArray[np.float64]:
        return np.array([self.angle_rad])

    def restore(self, state: NDArray[np.float64]) -> Observation:
        self.angle_rad = float(state[0])
        return self._observation()

    def scene(self) -> Sequence[SceneGeom]:
        return list(self._scene)

    def pose_at(self, state: NDArray[np.float64]) -> ScenePose:
        self.restore(state)
        return self.pose()

    def pose(self) -> ScenePose:
        poses = np.zeros((7, 7))
        poses[:, 3] = 1
        poses[1, :2] = self._position()
        heading = np.arctan2(
            np.cos(self.angle_rad) * ROAD_M[1], -np.sin(self.angle_rad) * ROAD_M[0]
        )
        poses[1, 3:] = (np.cos(heading / 2), 0, 0, np.sin(heading / 2))
        poses[2:, 0] = np.linspace(-12, 12, 5)
        return ScenePose(poses, np.append(self._position(), 1.0), poses[2:4, :3])

    def close(self) -> None:
        pass

    def _position(self) -> NDArray[np.float64]:
        sway = 1 + 0.12 * np.sin(3 * self.angle_rad)
        return road_at(np.array(self.angle_rad)) * sway

    def _observation(self) -> Observation:
        image = np.full((48, 96, 3), 90, np.uint8)
        image[:20] = (150, 190, 230)
        column = int(48 + 30 * np.sin(3 * self.angle_rad))
        image[20:, max(column - 8, 0) : column + 8] = (235, 235, 235)
        features = np.array([8.0, *self._position()], np.float32)
        return Observation({"front": image}, features, self.angle_rad / 0.6)


def drive(environment: RingRoad, steps: int) -> Episode:
    """Steps under a support gate whose score falls as the car sways off the centre line."""
    observation = environment.reset(1)
    recorded = []
    action = np.zeros(1, np.float32)
    for _ in range(steps):
        score = 0.25 - abs(0.4 * np.sin(3 * environment.angle_rad))
        inside = score > 0
        decision = GateDecision(
            Actor.POLICY if inside else Actor.EXPERT,
            not inside,
            Reason.INSIDE if inside else Reason.OUTSIDE,
            score,
            0.0,
        )
        recorded.append(Step(observation, environment.state(), action, None, decision, action, 0.0))
        observation = environment.step(action).observation
    return Episode(
        EpisodeInfo(SPEC.name, 1, Purpose.LEARNING, SPEC.control_rate_hz, method="sheath", round=2),
        tuple(recorded),
        observation,
        environment.state(),
        False,
        True,
        Outcome.TIME_LIMIT,
    )


def play(
    dashboard: Dashboard, environment: Environment, episode: Episode, speed: float = np.inf
) -> None:
    """Tell the page of a recorded episode as if it ran now, `speed` times as fast as it did."""
    assert isinstance(environment, Restorable)
    environment.reset(episode.info.seed)
    dashboard.on_start(environment, episode.info)
    states_after = [step.state for step in episode.steps[1:]] + [episode.final_state]
    for step, state in zip(episode.steps, states_after, strict=True):
        environment.restore(state)
        dashboard.on_step(environment, step)
        time.sleep(1 / (episode.info.control_rate_hz * speed))
    dashboard.on_end(episode)


@pytest.fixture
def environment() -> RingRoad:
    return RingRoad()


@pytest.fixture
def episode() -> Episode:
    return drive(RingRoad(), 150)


@pytest.fixture
def training() -> NDArray[np.float64]:
    """(300, 2) metres around the centre line."""
    rng = np.random.default_rng(0)
    around = road_at(np.linspace(0, 2 * np.pi, 300))
    return around + rng.normal(0, 0.9, around.shape)


def states_at(positions: NDArray) -> Samples:
    """Training states at (n, 2) positions."""
    features = np.column_stack([np.full(len(positions), 8.0), positions]).astype(np.float32)
    count = len(features)
    return Samples({}, features, np.zeros((count, 1), np.float32), np.zeros(count, np.int64))


@pytest.fixture
def token() -> str:
    return TOKEN


@pytest.fixture
def dashboard() -> Iterator[Dashboard]:
    with Dashboard(SPEC, port=0, token=TOKEN) as opened:
        yield opened


def slider(page: Page, place: int) -> Locator:
    """Of those to be seen, from above: viser gives them no name."""
    return page.get_by_role("slider").nth(place)
