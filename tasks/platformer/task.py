"""The platform game (the SHEATH draft, section V-A), on dm_control."""

from collections import OrderedDict, deque
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

import mujoco
import numpy as np
from dm_control import composer, mjcf
from dm_control.composer.observation import observable
from numpy.typing import NDArray

from sheath_manip.tasks.composer_environment import SheathTask
from sheath_manip.tasks.platformer.enemies import MOST_ENEMIES
from sheath_manip.tasks.platformer.features import REMEMBERED, Glimpse, Sight, feature_names
from sheath_manip.tasks.platformer.game import (
    CONTROL_RATE_HZ,
    TICKS,
    Buttons,
    End,
    Game,
    Moment,
    start_moment,
)
from sheath_manip.tasks.platformer.stage import LENGTH_TILES, Stage, draw_stage
from sheath_manip.tasks.platformer.world import MOST_BLOCKS, PARKED_M, BlockPool, build_world
from sheath_manip.tasks.rendering import PyramidCamera
from sheath_manip.types import ActionSpec, FirstView, Outcome, TaskSpec

TIME_LIMIT_S = 35.0
START_TILES = 2.0
"""over which the seed draws the start: the game has no chance, so that repeats from one place would
be exact copies; who starts farther on also meets every enemy at another time"""
CHOICES = tuple(
    Buttons(left, right, jump, speed)
    for left, right, jump, speed in product((False, True), repeat=4)
    if not (left and right)
)
"""all but left and right at once"""
_OUTCOMES = {
    End.NONE: Outcome.TIME_LIMIT,
    End.FLAG: Outcome.SUCCESS,
    End.DEATH: Outcome.FAILURE,
}
_NOTHING = Buttons(False, False, False, False)
_WALKER_RGBA, _HOPPER_RGBA = (0.42, 0.26, 0.14, 1.0), (0.5, 0.2, 0.55, 1.0)


@dataclass(frozen=True)
class Scenario:
    """A scenario: what a variant of the task may change."""

    difficulty: int = 1
    """0 and up: wider gaps, less flat ground between obstacles, more enemies"""
    stage: int | None = None
    """number of the one stage of all episodes, whose seeds then only move the start; None: the seed
    draws the stage, too"""
    image_px: int = 0
    """edge of the picture, 0 for none"""


class World(composer.Arena):
    """The model of `build_world`, as composer wants it."""

    _mjcf_root: Any  # mjcf makes its attributes from MuJoCo's schema at run time

    def _build(self, name: str | None = None) -> None:
        self._mjcf_root = build_world(MOST_BLOCKS, MOST_ENEMIES)
        if name:
            self._mjcf_root.model = name


class PlatformerTask(SheathTask):
    """Run and jump to the flag, without falling into a gap or running into an enemy."""

    # A tick depends on nothing but position and velocity, and the planner runs plain ticks.
    legacy_step = False

    def __init__(self, scenario: Scenario | None = None) -> None:
        self.scenario = scenario or Scenario()
        self._world = World()
        self._stage: Stage | None = None
        self._game: Game | None = None
        self._pool: BlockPool | None = None
        self._past: deque[Glimpse] = deque(maxlen=REMEMBERED)
        self._observables = OrderedDict(features=observable.Generic(self._features))
        cameras = {}
        if self.scenario.image_px:
            camera = PyramidCamera("side", self.scenario.image_px, pyramid_levels=0)
            self._observables["side"] = observable.Generic(camera)
            cameras["side"] = camera.shape
        for item in self._observables.values():
            item.enabled = True
        self.set_timesteps(1 / CONTROL_RATE_HZ, 1 / CONTROL_RATE_HZ / TICKS)
        self.spec = TaskSpec(
            name="platformer",
            control_rate_hz=CONTROL_RATE_HZ,
            action=ActionSpec(
                names=Buttons._fields,
                minimum=np.zeros(4, np.float32),
                maximum=np.ones(4, np.float32),
                choices=np.array(CHOICES, np.float32),
            ),
            cameras=cameras,
            feature_names=feature_names(),
            max_steps=round(TIME_LIMIT_S * CONTROL_RATE_HZ),
            metric="distance_tiles",
            first_view=FirstView(11.0, azimuth_deg=90.0, elevation_deg=12.0, follows=True),
        )

    @property
    def root_entity(self) -> composer.Entity:
        """The arena."""
        return self._world

    @property
    def task_observables(self) -> OrderedDict:
        """The features, and the picture where there is one."""
        return self._observables

    @property
    def stage(self) -> Stage:
        """The stage of the present episode."""
        assert self._stage is not None, "the task has not been reset yet"
        return self._stage

    @property
    def moment(self) -> Moment:
        """All that the rules know now."""
        return self.game.moment

    @property
    def game(self) -> Game:
        """The rules at work on this task's physics."""
        assert self._game is not None, "the task has not been reset yet"
        return self._game

    def after_compile(self, physics: mjcf.Physics, random_state) -> None:  # noqa: ARG002
        """Bind rules and blocks to the model."""
        self._game = Game(physics.model.ptr, physics.data.ptr)
        self._pool = BlockPool(physics.model.ptr)

    def initialize_episode(self, physics: mjcf.Physics, random_state) -> None:
        """Lay the stage and draw where the player starts."""
        number = self.scenario.stage
        if number is None:
            number = int(random_state.randint(2**31))
        self.play(physics, self._draw(number), float(random_state.uniform(0, START_TILES)))

    def _draw(self, number: int) -> Stage:
        return draw_stage(np.random.default_rng(number), self.scenario.difficulty)

    def play(self, physics: mjcf.Physics, stage: Stage, start_x_m: float) -> None:
        """Begin on `stage` at `start_x_m`; for tests and scripted starts too."""
        assert self._pool is not None
        self._stage = stage
        self._pool.lay(stage.blocks)
        self._sight = Sight(stage)
        self.game.begin(stage)
        self.put(physics, start_moment(stage, start_x_m))
        colours = [_HOPPER_RGBA if enemy.hops else _WALKER_RGBA for enemy in stage.enemies]
        model = physics.model.ptr
        first = model.geom("enemy_0").id
        # An enemy's body and its two eyes.
        model.geom_rgba[first : first + 3 * len(colours) : 3] = np.reshape(colours, (-1, 4))

    def tool_m(self, physics: mjcf.Physics) -> NDArray[np.float64]:  # noqa: ARG002
        """(3,) where the player is."""
        return np.array([self.moment.x, 0.0, self.moment.z])

    def put(self, physics: mjcf.Physics, moment: Moment) -> None:
        """Continue from `moment`, as if the player had stood there before."""
        self.game.put(moment)
        self._past.extend([Glimpse(moment, _NOTHING)] * REMEMBERED)
        self._show(physics)

    def before_step(self, physics: mjcf.Physics, action: NDArray, random_state) -> None:  # noqa: ARG002
        """Press the buttons that are more than half down."""
        left, right, jump, speed = (action > 0.5).tolist()
        buttons = Buttons(left, right, jump, speed)
        self._past.append(Glimpse(self.moment, buttons))
        self.game.press(buttons)

    def after_step(self, physics: mjcf.Physics, random_state) -> None:  # noqa: ARG002
        """Judge, and move what is to be seen."""
        self.game.judge()
        self._show(physics)

    def get_reward(self, physics: mjcf.Physics) -> float:  # noqa: ARG002
        """-1 for a death, 0 otherwise: learning from demonstrations needs no reward."""
        return -1.0 if self.moment.end is End.DEATH else 0.0

    def outcome(self) -> Outcome:
        """SUCCESS at the flag, FAILURE at a death."""
        return _OUTCOMES[self.moment.end]

    def metrics(self) -> Mapping[str, float]:
        """Return how far the player came, at most to the flag, and how many enemies it stomped."""
        distance = min(max(self.moment.farthest, 0.0), float(LENGTH_TILES))
        stomped = len(self.stage.enemies) - self.moment.alive.bit_count()
        return {
            "distance_tiles": distance,
            "progress": distance / LENGTH_TILES,
            "stomped": float(stomped),
        }

    def memory(self) -> NDArray[np.float64]:
        """(m,) the present moment, then the remembered glimpses."""
        rows = [self.moment, *(number for glimpse in self._past for number in glimpse)]
        return np.array([number for row in rows for number in row], float)

    def recall(self, memory: NDArray[np.float64]) -> None:
        """Take over a `memory()`."""
        numbers = iter(memory.tolist())
        self.game.put(_moment(numbers))
        self._past.extend(
            Glimpse(_moment(numbers), Buttons(*(next(numbers) > 0.5 for _ in range(4))))
            for _ in range(REMEMBERED)
        )

    def _features(self, physics: mjcf.Physics) -> NDArray[np.float32]:  # noqa: ARG002
        return self._sight.features(self.moment, self._past)

    def _show(self, physics: mjcf.Physics) -> None:
        """Move the enemies, which the physics does not know, to where the rules say they are."""
        moment = self.moment
        places = [
            (x, 0.0, z) if moment.alive >> index & 1 else PARKED_M
            for index, (x, z) in enumerate(
                enemy.position(moment.step) for enemy in self.stage.enemies
            )
        ]
        places += [PARKED_M] * (MOST_ENEMIES - len(places))
        model, data = physics.model.ptr, physics.data.ptr
        data.mocap_pos[:] = places
        # A tick leaves the bodies where they were before it.
        mujoco.mj_kinematics(model, data)
        mujoco.mj_camlight(model, data)


def _moment(numbers) -> Moment:
    x, z, vx, vz, step, alive, held, grounded, end, farthest = (next(numbers) for _ in range(10))
    return Moment(
        x, z, vx, vz, int(step), int(alive), bool(held), bool(grounded), End(int(end)), farthest
    )
