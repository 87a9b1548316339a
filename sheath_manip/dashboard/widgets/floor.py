"""A floor under a scene that stands on nothing, so that its shadows fall somewhere."""

import numpy as np

from sheath_manip.dashboard.scene import SLAB_M, WORLD, plain
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.types import SceneGeom

COLOR = (196, 201, 207)
TIMES = 14.0
"""half the plane that things stand on: so wide is the floor around it"""


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
        self._scene.add_box(
            f"{WORLD}/floor",
            COLOR,
            (TIMES * half, TIMES * half, SLAB_M),
            # Right below: a robot that stands beside the plane stands on the floor.
            position=centre - [0, 0, 1.5 * SLAB_M],
            cast_shadow=False,
        )
