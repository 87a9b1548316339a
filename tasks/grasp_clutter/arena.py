"""The table and its pool of objects, as MJCF."""

from typing import Any

from dm_control import composer, mjcf

from sheath_manip.tasks.assets import assets_of
from sheath_manip.tasks.grasp_clutter.pool import add_pool

ASSETS = assets_of("grasp_clutter")


class TableArena(composer.Arena):
    """The arena of the table: all but the robot."""

    _mjcf_root: Any  # mjcf makes its attributes from MuJoCo's schema at run time

    def _build(self, name: str = "table") -> None:
        self._mjcf_root = mjcf.from_path(str(ASSETS / "table.xml"))
        self._mjcf_root.model = name
        add_pool(self._mjcf_root, movable=True)
