"""A floor under a scene that stands on nothing, so that its shadows fall somewhere."""

import numpy as np

from sheath_manip.dashboard.scene import SLAB_M, WORLD, plain
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.types import SceneGeom

COLOR = (196, 201, 207)
TIMES = 14.0
"""the plane that things stand on: so wide is the floor around it"""
PEDESTAL_M = 0.03
"""by which the plane lies above the floor"""


class Floor:
    """Lies below the plane of one colour that a task has, such as a table; else there is none.

    A plane with a picture, or with no end, is a ground already.
    """

    def __init__(self, context: WidgetContext) -> None:
        self._scene = context.viser.scene
        self._under: tuple[SceneGeom, ...] | None = None

    def draw(self, snapshot: Snapshot) -> None:
        """Lay it under a scene that is new."""
        if snapshot.scene is self._under:
            return
        self._under = snapshot.scene
        planes = [geom for geom in snapshot.scene if plain(geom) is not None]
        if not planes:
            return
        plane = min(planes, key=lambda geom: snapshot.pose.bodies[geom.body, 2])
        centre = snapshot.pose.bodies[plane.body, :3] + plane.position_in_body
        half = float(np.max(plane.size[:2]))
        # A block below the plane, as wide as that: the robot and the things on it stand there.
        self._scene.add_box(
            f"{WORLD}/pedestal",
            tuple(round(0.55 * channel) for channel in COLOR),
            (2 * plane.size[0], 2 * plane.size[1], PEDESTAL_M),
            position=centre - [0, 0, SLAB_M + PEDESTAL_M / 2],
        )
        self._scene.add_box(
            f"{WORLD}/floor",
            COLOR,
            (TIMES * half, TIMES * half, SLAB_M),
            position=centre - [0, 0, SLAB_M + PEDESTAL_M],
            cast_shadow=False,
        )
