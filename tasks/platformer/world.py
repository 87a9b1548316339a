"""The MuJoCo model: a player, and pools of blocks and enemies that a new stage moves about."""

from typing import Any

import mujoco
import numpy as np
from dm_control import mjcf

from sheath_manip.exceptions import ParameterError
from sheath_manip.tasks.assets import assets_of
from sheath_manip.tasks.platformer.stage import LENGTH_TILES, Block

ASSETS = assets_of("platformer")

MOST_BLOCKS = 90
_HALF_DEPTH_M = 0.5
_GROUND_RGBA, _PIPE_RGBA = (0.62, 0.42, 0.26, 1.0), (0.2, 0.62, 0.24, 1.0)
_PARKED = Block(-14.0, -13.0, 1.0)
"""within the wall at the left end, where nothing shows or is touched"""
PARKED_M = (-13.0, 0.0, 2.0)
"""where enemies wait that a stage does not need, in that wall too"""


def build_world(blocks: int, enemies: int) -> mjcf.RootElement:
    """The model with pools of so many blocks and enemies."""
    root: Any = mjcf.from_path(str(ASSETS / "world.xml"))
    for number in range(blocks):
        # Off the origin, where the compiler would note for good that a geom is at its body's place.
        place = {"pos": [1, 0, 1], "size": [0.5, _HALF_DEPTH_M, 0.5]}
        root.worldbody.add("geom", name=f"block_{number}", dclass="block", **place)
    for number in range(enemies):
        body = root.worldbody.add("body", name=f"enemy_{number}", mocap="true", pos=PARKED_M)
        body.add("geom", name=f"enemy_{number}", dclass="enemy")
        for side in (-0.15, 0.15):
            body.add("geom", type="sphere", size=[0.09], pos=[side, -0.36, 0.12], rgba=[1, 1, 1, 1])
    root.worldbody.add(
        "geom", type="box", size=[0.08, 0.08, 6.0], pos=[LENGTH_TILES, 0.6, 6], rgba=[1, 1, 1, 1]
    )
    root.worldbody.add(
        "geom", type="box", size=[0.9, 0.05, 0.6], pos=[LENGTH_TILES - 0.9, 0.6, 11.3],
        rgba=[0.1, 0.7, 0.2, 1],
    )  # fmt: skip
    return root


class BlockPool:
    """The blocks of one compiled model. A stage is laid without compiling anything."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self._model = model
        names = (model.geom(index).name.split("/")[-1] for index in range(model.ngeom))
        self._geoms = [i for i, name in enumerate(names) if name.startswith("block_")]

    def lay(self, blocks: tuple[Block, ...]) -> None:
        """Move the pool to `blocks`, in their order, and what is left over out of sight."""
        spare = len(self._geoms) - len(blocks)
        if spare < 0:
            raise ParameterError(f"{len(blocks)} blocks; the pool holds {len(self._geoms)}")
        laid = (*blocks, *[_PARKED] * spare)
        left, right, height, pipe = np.array(
            [(each.left, each.right, each.height, each.pipe) for each in laid]
        ).T
        first, model = self._geoms[0], self._model
        rows = slice(first, first + len(self._geoms))
        model.geom_pos[rows, 0] = (left + right) / 2
        model.geom_pos[rows, 2] = height / 2
        model.geom_size[rows, 0] = (right - left) / 2
        model.geom_size[rows, 2] = height / 2
        model.geom_rgba[rows] = np.where(pipe[:, None] > 0, _PIPE_RGBA, _GROUND_RGBA)
        # What the broad phase takes for the radius of a sphere around the box.
        model.geom_rbound[rows] = np.sqrt(
            model.geom_size[rows, 0] ** 2 + _HALF_DEPTH_M**2 + model.geom_size[rows, 2] ** 2
        )
