"""The rules: what the buttons do, when an enemy dies and when the player does.

There is one implementation, which the task and the expert's planner run on a MuJoCo model of their
own each, so that what was planned is what happens, to the bit.
"""

from enum import IntEnum
from typing import NamedTuple

import mujoco

from sheath_manip.tasks.platformer.stage import LEAD_TILES, LENGTH_TILES, Stage

CONTROL_RATE_HZ = 24.0
TICKS = 4
"""of physics in a control step"""
GRAVITY_M_S2 = 50.0
"""of the world's file"""
ACCELERATION_M_S2 = 40.0
"""at most, on the ground and in the air; of its actuator's force on 1 kg"""
WALK_M_S, RUN_M_S = 6.0, 10.0
JUMP_M_S = 20.5
"""4.2 m high and 8.2 m far at a run under the world's gravity, with the button held"""
CUT_M_S = 7.0
"""what is left of a rise once the button is let go"""
STOMP_M_S = 12.0
"""how an enemy throws the player up who stomps it"""
FALL_M_S = 20.0
"""no fall is faster, so that a tick never takes the player through the ground"""
RADIUS_M = 0.45
_TOUCH_M = 0.8
"""between the centres of player and enemy, along each axis"""
_STOMP_ABOVE_M = 0.4
"""from where, above the enemy's centre, a falling player must have come to stomp it"""
_NEAR_TILES = 3
"""in which the rules look for enemies: more than any distance that they ask for"""
_FLOOR_COSINE = 0.5
"""between a contact's normal and the vertical: steeper ones are walls"""


class Buttons(NamedTuple):
    """The buttons that are pressed during a control step."""

    left: bool
    right: bool
    jump: bool
    speed: bool


class End(IntEnum):
    """The end of a game, if any: how it stands."""

    NONE = 0
    FLAG = 1
    DEATH = 2


class Moment(NamedTuple):
    """A moment of the game: all that the next step depends on, between two control steps."""

    x: float
    """m, as the next three are m and m/s: of the player's centre"""
    z: float
    vx: float
    vz: float
    step: int
    """control steps since the start, which the enemies' places follow from"""
    alive: int
    """bit i: enemy i lives"""
    held: bool
    """jump was pressed: it must be let go before the next jump"""
    grounded: bool
    end: End
    farthest: float
    """m, largest x so far"""


def start_moment(stage: Stage, x: float) -> Moment:
    """Return a moment at rest on the ground at `x` (m), with all enemies alive."""
    # A millimetre deep, which is where the contact carries the player's weight.
    z = float(stage.heights[int(x) + LEAD_TILES]) + RADIUS_M - 0.001
    alive = (1 << len(stage.enemies)) - 1
    return Moment(x, z, 0.0, 0.0, 0, alive, False, True, End.NONE, x)


class Game:
    """The rules on one model, which has the player's two joints first."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        self._model, self._data = model, data
        # Views into MuJoCo's memory: to fetch them anew takes as long as a tick.
        self._qpos, self._qvel, self._ctrl = data.qpos, data.qvel, data.ctrl
        self.moment = Moment(0.0, 0.0, 0.0, 0.0, 0, 0, False, True, End.NONE, 0.0)
        self._stage: Stage | None = None
        self._near: list[tuple[int, ...]] = []

    def begin(self, stage: Stage) -> None:
        """Play on `stage`, whose blocks are laid already."""
        self._stage = stage
        self._near = stage.enemies_around(_NEAR_TILES, _NEAR_TILES)

    def put(self, moment: Moment) -> None:
        """Continue from `moment`."""
        self.moment = moment
        self._qpos[0], self._qpos[1] = moment.x, moment.z
        self._qvel[0], self._qvel[1] = moment.vx, moment.vz

    def press(self, buttons: Buttons) -> None:
        """Press the buttons before the ticks of a control step."""
        moment, vz = self.moment, self.moment.vz
        top = RUN_M_S if buttons.speed else WALK_M_S
        self._ctrl[0] = (buttons.right - buttons.left) * top
        if buttons.jump:
            if moment.grounded and not moment.held:
                self._qvel[1] = JUMP_M_S
        elif vz > CUT_M_S:
            self._qvel[1] = CUT_M_S
        if vz < -FALL_M_S:
            self._qvel[1] = -FALL_M_S
        self.moment = moment._replace(held=buttons.jump)

    def play(self, buttons: Buttons) -> Moment:
        """A whole control step, where nobody else runs the physics."""
        self.press(buttons)
        mujoco.mj_step(self._model, self._data, TICKS)
        return self.judge()

    def judge(self) -> Moment:
        """Judge how the game stands after the ticks of a control step."""
        assert self._stage is not None
        before = self.moment
        x, z = self._qpos.tolist()[:2]
        vx, vz = self._qvel.tolist()[:2]
        step, alive, end = before.step + 1, before.alive, before.end
        if z < 0.0:
            end = End.DEATH
        for index in self._near[int(x + LEAD_TILES)]:
            if alive >> index & 1:
                enemy_x, enemy_z = self._stage.enemies[index].position(step)
                if abs(x - enemy_x) < _TOUCH_M and abs(z - enemy_z) < _TOUCH_M:
                    came_from = z - vz / CONTROL_RATE_HZ
                    if vz < 0.0 and came_from > enemy_z + _STOMP_ABOVE_M:
                        alive &= ~(1 << index)
                        vz = STOMP_M_S if before.held else CUT_M_S
                        self._qvel[1] = vz
                    else:
                        end = End.DEATH
        if end is End.NONE and x >= LENGTH_TILES:
            end = End.FLAG
        self.moment = Moment(
            x, z, vx, vz, step, alive, before.held, self._on_ground(), end,
            max(before.farthest, x),
        )  # fmt: skip
        return self.moment

    def enemy_ahead(self, moment: Moment, within_m: float) -> bool:
        """Return whether a living enemy is `within_m` or less to the right, at the same height."""
        assert self._stage is not None
        for index in self._near[int(moment.x + LEAD_TILES)]:
            if moment.alive >> index & 1:
                x, z = self._stage.enemies[index].position(moment.step)
                if 0 < x - moment.x < within_m and abs(z - moment.z) < 1.0:
                    return True
        return False

    def _on_ground(self) -> bool:
        if not self._data.ncon:
            return False
        normals = self._data.contact.frame[:, 2].tolist()
        return any(abs(cosine) > _FLOOR_COSINE for cosine in normals)
