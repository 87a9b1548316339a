"""What the player knows, as binary features: tile grids of three moments, and its own state.

After the platform game of Ross, Gordon and Bagnell (2011), who give a linear policy the tiles
around the player in the last frames, whether it stands and may jump, and its last actions.
"""

from collections.abc import Sequence
from itertools import product
from math import floor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sheath_manip.tasks.platformer.game import RADIUS_M, Buttons, Moment
from sheath_manip.tasks.platformer.stage import LEAD_TILES, Stage

COLUMNS = range(-3, 10)
"""tiles of the grid, from the player's own: behind and ahead"""
ROWS = range(-5, 3)
"""below and above"""
LAGS = (0, 3, 6)
"""how many control steps ago a grid was seen"""
_LAST_ACTIONS = 3
REMEMBERED = max(*LAGS, _LAST_ACTIONS)
"""how many earlier steps the features look back at"""
_EDGES_VX = np.array([-7.0, -3.0, -0.3, 0.3, 3.0, 5.5, 6.5, 9.0])
_EDGES_VZ = np.array([-15.0, -8.0, -2.0, -0.5, 0.5, 4.0, 8.0, 14.0])
_SUBTILES = 4
"""parts of a tile by which the player's own place is told"""


class Glimpse(NamedTuple):
    """What later features need of an earlier step."""

    moment: Moment
    buttons: Buttons
    """that were pressed then"""


def feature_names() -> tuple[str, ...]:
    """Return a name for each feature, all of which are 0 or 1."""
    grids = [
        f"{what}_{lag}_steps_ago_{column:+d}_{row:+d}_tiles"
        for lag in LAGS
        for what in ("solid", "enemy")
        for column, row in product(COLUMNS, ROWS)
    ]
    own = ["on_ground", "may_jump", "jump_held"]
    own += [f"vx_bucket_{index}" for index in range(len(_EDGES_VX) + 1)]
    own += [f"vz_bucket_{index}" for index in range(len(_EDGES_VZ) + 1)]
    own += [f"{axis}_within_tile_{part}" for axis in "xz" for part in range(_SUBTILES)]
    actions = [
        f"{button}_{ago}_steps_ago"
        for ago in range(1, _LAST_ACTIONS + 1)
        for button in Buttons._fields
    ]
    return (*grids, *own, *actions)


class Sight:
    """Computes the features of one stage; keeps the grids of the steps that it has seen."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._rows = np.arange(ROWS.start, ROWS.stop)
        self._grids: dict[Moment, NDArray[np.float32]] = {}
        self._near = stage.enemies_around(-COLUMNS.start, COLUMNS.stop)

    def features(self, moment: Moment, past: Sequence[Glimpse]) -> NDArray[np.float32]:
        """Return the (f,) of `moment`, after the last `REMEMBERED` glimpses, the newest last."""
        grids = [self._grid(moment)]
        grids += [self._grid(past[-lag].moment) for lag in LAGS[1:]]
        if len(self._grids) > 4 * REMEMBERED:
            self._grids.clear()
        actions = [past[-ago].buttons for ago in range(1, _LAST_ACTIONS + 1)]
        return np.concatenate([*grids, _own(moment), np.array(actions, np.float32).ravel()])

    def _grid(self, moment: Moment) -> NDArray[np.float32]:
        """(2 · columns · rows,) solid tiles, then enemies, columns from behind to ahead."""
        if (known := self._grids.get(moment)) is not None:
            return known
        column, row = floor(moment.x), floor(moment.z)
        first = column + LEAD_TILES + COLUMNS.start
        heights = self._stage.heights[first : first + len(COLUMNS)]
        grid = np.zeros((2, len(COLUMNS), len(ROWS)), np.float32)
        grid[0] = heights[:, None] > row + self._rows
        for index in self._near[column + LEAD_TILES]:
            if moment.alive >> index & 1:
                x, z = self._stage.enemies[index].position(moment.step)
                across = floor(x) - column - COLUMNS.start
                up = floor(z) - row - ROWS.start
                if 0 <= across < len(COLUMNS) and 0 <= up < len(ROWS):
                    grid[1, across, up] = 1.0
        self._grids[moment] = grid.ravel()
        return self._grids[moment]


def _own(moment: Moment) -> NDArray[np.float32]:
    own = np.zeros(3 + len(_EDGES_VX) + 1 + len(_EDGES_VZ) + 1 + 2 * _SUBTILES, np.float32)
    own[0] = moment.grounded
    own[1] = moment.grounded and not moment.held
    own[2] = moment.held
    at = 3
    own[at + int(_EDGES_VX.searchsorted(moment.vx))] = 1.0
    at += len(_EDGES_VX) + 1
    own[at + int(_EDGES_VZ.searchsorted(moment.vz))] = 1.0
    at += len(_EDGES_VZ) + 1
    # Of the height, the lower end: it says how far above the ground the player is, which it
    # stands a millimetre deep in.
    for place in (moment.x, moment.z - RADIUS_M + 0.01):
        own[at + int(_SUBTILES * (place - floor(place)))] = 1.0
        at += _SUBTILES
    return own
