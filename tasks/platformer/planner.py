"""A* through the game's own physics and rules, on a small model of the planner's own."""

from itertools import pairwise
from math import floor
from typing import NamedTuple

from dm_control import mjcf

from sheath_manip.controllers.astar import AStar, Plan
from sheath_manip.tasks.platformer.game import (
    ACCELERATION_M_S2,
    CONTROL_RATE_HZ,
    GRAVITY_M_S2,
    RADIUS_M,
    RUN_M_S,
    Buttons,
    End,
    Game,
    Moment,
)
from sheath_manip.tasks.platformer.stage import LEAD_TILES, LENGTH_TILES, Stage
from sheath_manip.tasks.platformer.world import BlockPool, build_world

_RIGHT, _LEFT = Buttons(False, True, False, False), Buttons(True, False, False, False)
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
"""control steps for which a plan holds an action"""
HORIZON_M = 12.0
"""planned ahead: what the features show, and half a jump more"""
_JUMP_S = 0.02
"""what a pressed jump costs beside its time, so that nobody jumps for nothing"""
_WALK_S = 0.03
"""what an action without speed costs as well: now a run and now a walk, for no reason that one
could see, is hard to imitate"""
_EDGE_M, _EDGE_S = 1.2, 0.06
"""how near to a gap the ground is avoided, and at what price: who jumps from the very edge is lost
where the button comes a step late, as a policy's will"""
_ENEMY_M, _ENEMY_S = 2.0, 0.06
"""how near to an enemy ahead an action costs the same"""
_WALL_M, _CLIMB_S = 1.0, 0.1
"""how near a wall is next, and the seconds that each metre of it takes which no jump under way
will clear: without them a search at its foot tries all else before it goes up"""
_BLOCKS = 24
"""around the player: few of them make a tick cheaper, which is most of a plan's time"""
_BEHIND_M, _BEYOND_M = 8.0, 10.0
"""of the stage that a plan may touch, before the player and beyond the horizon"""


class _Gap(NamedTuple):
    left: float
    left_height: float
    right: float
    right_height: float


class Planner:
    """Finds the quickest way onwards from any moment of a game."""

    def __init__(self, most_nodes: int = 240, weight: float = 1.4) -> None:
        # No enemies: the rules know where they are, and bodies would cost time at every tick.
        self._physics = mjcf.Physics.from_mjcf_model(build_world(_BLOCKS, enemies=0))
        model, data = self._physics.model.ptr, self._physics.data.ptr
        self._pool = BlockPool(model)
        self._game = Game(model, data)
        self._stage: Stage | None = None
        self._gaps: list[_Gap | None] = []
        self._heights: list[int] = []
        self._goal_m = 0.0
        self._search = AStar(
            actions=len(ACTIONS),
            cost=self._cost,
            successor=self._successor,
            estimate=self._estimate,
            key=_key,
            rests=_stands,
            weight=weight,
            most_nodes=most_nodes,
        )

    def begin(self, stage: Stage) -> None:
        """Plan on `stage` from now on."""
        self._stage = stage
        self._game.begin(stage)
        self._heights = stage.heights.tolist()
        self._gaps = [None] * len(stage.heights)
        for before, behind in pairwise(stage.blocks):
            gap = _Gap(before.right, before.height, behind.left, behind.height)
            for column in range(int(gap.left), int(gap.right)):
                self._gaps[column + LEAD_TILES] = gap

    def plan(self, start: Moment) -> Plan[Moment]:
        """The way to a horizon ahead, or to the flag; its actions are indices of `ACTIONS`."""
        assert self._stage is not None, "begin a stage before planning on it"
        first, last = start.x - _BEHIND_M, start.x + HORIZON_M + _BEYOND_M
        near = [block for block in self._stage.blocks if block.right > first and block.left < last]
        self._pool.lay(tuple(near[:_BLOCKS]))
        self._goal_m = min(start.x + HORIZON_M, float(LENGTH_TILES))
        return self._search.plan(start)

    def followed(self, plan: Plan[Moment], steps: int) -> list[tuple[Moment, Buttons]]:
        """The last plan's first control steps, one by one: a moment and what is pressed in it."""
        way: list[tuple[Moment, Buttons]] = []
        self._game.put(plan.states[0])
        for action in plan.actions[: steps // MACRO_STEPS]:
            for _ in range(MACRO_STEPS):
                way.append((self._game.moment, ACTIONS[action]))
                if self._game.play(ACTIONS[action]).end is not End.NONE:
                    return way
        return way

    def _successor(self, moment: Moment, action: int) -> Moment | None:
        game, buttons = self._game, ACTIONS[action]
        game.put(moment)
        for _ in range(MACRO_STEPS):
            moment = game.play(buttons)
            if moment.end is not End.NONE:
                return None if moment.end is End.DEATH else moment
        return None if self._falls(moment) else moment

    def _cost(self, action: int, moment: Moment) -> float:
        """Seconds, and what is avoided at the price of some."""
        buttons = ACTIONS[action]
        cost = MACRO_STEPS / CONTROL_RATE_HZ + _JUMP_S * buttons.jump
        cost += _WALK_S * (not buttons.speed)
        if moment.grounded and moment.vx > 1.0:
            if self._gaps[floor(moment.x + _EDGE_M) + LEAD_TILES] is not None:
                cost += _EDGE_S
            elif self._game.enemy_ahead(moment, _ENEMY_M):
                cost += _ENEMY_S
        return cost

    def _estimate(self, moment: Moment) -> float:
        """Seconds to the goal, from this speed up to a run, and up the wall that is next."""
        away = self._goal_m - moment.x
        if moment.end is End.FLAG or away <= 0:
            return 0.0
        lacking = max(RUN_M_S - moment.vx, 0.0)
        seconds = away / RUN_M_S + lacking**2 / (2 * ACCELERATION_M_S2 * RUN_M_S)
        wall = self._heights[floor(moment.x + _WALL_M) + LEAD_TILES]
        if wall > moment.z:
            top = moment.z + max(moment.vz, 0.0) ** 2 / (2 * GRAVITY_M_S2)
            seconds += _CLIMB_S * max(wall - top, 0.0)
        return seconds

    def _falls(self, moment: Moment) -> bool:
        """Over a gap, and even at a run too far from either rim.

        A fall takes a third of a second, in which a search would try whatever one can press.
        """
        gap = self._gaps[floor(moment.x) + LEAD_TILES]
        if gap is None:
            return False
        ahead, behind = gap.right - moment.x, moment.x - gap.left
        above_ahead, above_behind = moment.z - gap.right_height, moment.z - gap.left_height
        return (
            _reach(above_ahead, moment.vz, moment.vx) < ahead - RADIUS_M
            and _reach(above_behind, moment.vz, -moment.vx) < behind - RADIUS_M
        )


def _reach(above_m: float, rising_m_s: float, towards_m_s: float) -> float:
    """How far (m) a ball flies towards a rim `above_m` below it, speeding up to a run."""
    under_root = rising_m_s**2 + 2 * GRAVITY_M_S2 * above_m
    if under_root < 0:
        return -float("inf")
    time_s = (rising_m_s + under_root**0.5) / GRAVITY_M_S2
    lacking = RUN_M_S - towards_m_s
    speeding_s = lacking / ACCELERATION_M_S2
    if time_s < speeding_s:
        return towards_m_s * time_s + ACCELERATION_M_S2 * time_s**2 / 2
    return RUN_M_S * time_s - lacking * speeding_s / 2


def _stands(moment: Moment) -> bool:
    return moment.grounded


def _key(moment: Moment) -> tuple:
    """Quarter tiles, m/s by twos, sixths of a second: enough to tell ways apart."""
    return (
        floor(4 * moment.x), floor(4 * moment.z), round(moment.vx / 2), round(moment.vz / 2),
        moment.step // 4, moment.alive, moment.held, moment.grounded,
    )  # fmt: skip
