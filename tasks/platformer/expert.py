"""The platformer's expert: A* through the game's own physics, on a model of its own.

The draft's expert is an A* planner, too (section V-A). A plan is kept and followed as long as the
game is, to the bit, where the plan said it would be; anywhere else the expert plans anew.
"""

from itertools import pairwise
from math import floor

import numpy as np
from dm_control import mjcf

from controllers.astar import AStar, Plan
from sheath_manip.types import Action, Observation
from tasks.composer_environment import ComposerEnvironment
from tasks.platformer.game import (
    CONTROL_RATE_HZ,
    GRAVITY_M_S2,
    RADIUS_M,
    RUN_M_S,
    Buttons,
    End,
    Game,
    Moment,
)
from tasks.platformer.stage import LEAD_TILES, LENGTH_TILES, Block, Stage
from tasks.platformer.task import PlatformerTask
from tasks.platformer.world import BlockPool, build_world

_LEFT, _RIGHT = Buttons(True, False, False, False), Buttons(False, True, False, False)
_REST = Buttons(False, False, False, False)
ACTIONS = (
    _RIGHT._replace(speed=True),
    _RIGHT._replace(speed=True, jump=True),
    _RIGHT,
    _RIGHT._replace(jump=True),
    _REST,
    _REST._replace(jump=True),
    _LEFT,
    _LEFT._replace(jump=True),
)
"""what a plan is made of, in the order in which it is tried"""
MACRO_STEPS = 2
"""control steps for which an action is held in a plan"""
HORIZON_M = 12.0
"""planned ahead: what a grid of features shows, and a jump more"""
FOLLOWED_STEPS = 8
"""of a plan, before another one looks farther ahead"""
_JUMP_S = 0.02
"""what a jump's press costs beside its time: it jumps where it must"""
_EDGE_M, _EDGE_S = 1.2, 0.06
"""how near to a gap the ground is avoided, and at what price: whoever jumps at the very edge is
lost if the button comes a step late"""
_ENEMY_M, _ENEMY_S = 2.0, 0.06
"""likewise, how near to an enemy ahead"""
_ACCELERATION_M_S2 = 40.0
"""of the actuator in the world's file"""


class Planner:
    """Finds ways over a stage, on a small model with the blocks near the player."""

    def __init__(self, most_nodes: int = 240, weight: float = 1.4) -> None:
        self._blocks = 24
        # No enemies: in the rules they are numbers, and bodies would cost time at every tick.
        self._physics = mjcf.Physics.from_mjcf_model(build_world(self._blocks, 0))
        model, data = self._physics.model.ptr, self._physics.data.ptr
        self._pool = BlockPool(model)
        self._game = Game(model, data)
        self._goal_m = 0.0
        self._search = AStar(
            actions=len(ACTIONS),
            cost=self._cost,
            successor=self._successor,
            estimate=self._estimate,
            key=_key,
            rests=lambda moment: moment.grounded,
            weight=weight,
            most_nodes=most_nodes,
        )
        self._stage: Stage | None = None

    def begin(self, stage: Stage) -> None:
        """Plan on `stage` from now on."""
        self._stage = stage
        self._game.begin(stage)
        self._gaps: list[tuple[float, float, float, float] | None] = [None] * len(stage.heights)
        for before, behind in pairwise(stage.blocks):
            for column in range(int(before.right), int(behind.left)):
                gap = before.right, before.height, behind.left, behind.height
                self._gaps[column + LEAD_TILES] = gap

    def plan(self, start: Moment) -> Plan[Moment]:
        """The way to firm ground a horizon ahead, or to the flag; the actions are of `ACTIONS`."""
        assert self._stage is not None
        self._pool.lay(self._blocks_near(self._stage, start.x))
        self._goal_m = min(start.x + HORIZON_M, float(LENGTH_TILES))
        return self._search.plan(start)

    def followed(self, plan: Plan[Moment], steps: int) -> list[tuple[Moment, Buttons]]:
        """The plan's first control steps, one by one: each moment and what is pressed in it."""
        game, way = self._game, []
        game.put(plan.states[0])
        for action in plan.actions[: -(-steps // MACRO_STEPS)]:
            for _ in range(MACRO_STEPS):
                way.append((game.moment, ACTIONS[action]))
                game.press(ACTIONS[action])
                game.tick()
                if game.judge().end is not End.NONE:
                    return way
        return way

    def _blocks_near(self, stage: Stage, x: float) -> tuple[Block, ...]:
        first, last = x - 8.0, x + HORIZON_M + 10.0
        near = [block for block in stage.blocks if block.right > first and block.left < last]
        return tuple(near[: self._blocks])

    def _successor(self, moment: Moment, action: int) -> Moment | None:
        game, buttons = self._game, ACTIONS[action]
        game.put(moment)
        for _ in range(MACRO_STEPS):
            game.press(buttons)
            game.tick()
            moment = game.judge()
            if moment.end is not End.NONE:
                return None if moment.end is End.DEATH else moment
        return None if self._falls(moment) else moment

    def _falls(self, moment: Moment) -> bool:
        """Over a gap and, as a ball in flight, out of reach of either of its rims."""
        if (gap := self._gaps[floor(moment.x) + LEAD_TILES]) is None:
            return False
        left, left_height, right, right_height = gap
        for away, height, speed in (
            (right - moment.x, right_height, moment.vx),
            (moment.x - left, left_height, -moment.vx),
        ):
            # Centres above the rim roll onto it.
            drop = moment.z - height
            under_root = moment.vz**2 + 2 * GRAVITY_M_S2 * drop
            if under_root < 0:
                continue
            time_s = (moment.vz + under_root**0.5) / GRAVITY_M_S2
            lacking = RUN_M_S - speed
            gained = lacking / _ACCELERATION_M_S2
            if time_s < gained:
                reach = speed * time_s + _ACCELERATION_M_S2 * time_s**2 / 2
            else:
                reach = RUN_M_S * time_s - lacking * gained / 2
            if reach >= away - RADIUS_M:
                return False
        return True

    def _cost(self, action: int, moment: Moment) -> float:
        """Seconds, and what is to be avoided at the price of some."""
        cost = MACRO_STEPS / CONTROL_RATE_HZ + _JUMP_S * ACTIONS[action].jump
        if moment.grounded and moment.vx > 1.0:
            if self._gaps[floor(moment.x + _EDGE_M) + LEAD_TILES] is not None:
                cost += _EDGE_S
            elif self._game.enemy_within(_ENEMY_M):
                cost += _ENEMY_S
        return cost

    def _estimate(self, moment: Moment) -> float:
        """Seconds to the goal, from this speed to a run and on."""
        if moment.end is End.FLAG:
            return 0.0
        away = self._goal_m - moment.x
        if away <= 0:
            return 0.0
        lacking = max(RUN_M_S - moment.vx, 0.0)
        return away / RUN_M_S + lacking**2 / (2 * _ACCELERATION_M_S2 * RUN_M_S)


def _key(moment: Moment) -> tuple:
    """Quarter tiles, m/s by twos, sixths of a second: enough to tell ways apart."""
    return (
        floor(4 * moment.x), floor(4 * moment.z), round(moment.vx / 2), round(moment.vz / 2),
        moment.step // 4, moment.alive, moment.held, moment.grounded,
    )  # fmt: skip


class PlatformerExpert:
    """Plans from any state; sees the stage and the enemies as they are."""

    def __init__(self, environment: ComposerEnvironment) -> None:
        if not isinstance(environment.task, PlatformerTask):
            raise TypeError(f"PlatformerExpert wants a PlatformerTask, got {environment.task!r}")
        self._task = environment.task
        self.planner = Planner()
        self._stage: Stage | None = None
        self._way: dict[Moment, Buttons] = {}

    def reset(self) -> None:
        """Forget the plan."""
        self._way = {}

    def act(self, observation: Observation) -> Action:  # noqa: ARG002
        """(4,) buttons, 0 or 1."""
        return np.array(self.buttons(), np.float32)

    def buttons(self) -> Buttons:
        """What to press now."""
        moment = self._task.moment
        if self._task.stage is not self._stage:
            self._stage, self._way = self._task.stage, {}
            self.planner.begin(self._stage)
        if moment not in self._way:
            plan = self.planner.plan(moment)
            self._way = dict(self.planner.followed(plan, FOLLOWED_STEPS))
        # Where every action leads to death there is no plan; running on is as good as any.
        return self._way.get(moment, ACTIONS[0])
