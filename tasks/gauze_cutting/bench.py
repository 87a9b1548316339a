"""The bench: table, clips, and the sheet with its print, as MJCF."""

from typing import Any

import cv2
import numpy as np
from dm_control import composer, mjcf
from numpy.typing import NDArray

from sheath_manip.tasks.assets import assets_of
from sheath_manip.tasks.gauze_cutting.cutting.flexcomp import add_sheet
from sheath_manip.tasks.gauze_cutting.geometry import (
    CENTRE_M,
    CLIP_M,
    CLIP_OF_VERTEX,
    DAMPING_S,
    MASS_KG,
    MEMBRANE,
    MESH,
    RADIUS_M,
    SIDE_M,
    SPARE_TRIANGLES,
)

ASSETS = assets_of("gauze_cutting")
SHEET = "gauze"
CLIPS = tuple(f"clip_{number}" for number in range(4))
_PRINT_PX = 512
_LINE_M = 0.0018
"""width of the printed line: over a pixel of the policy's camera"""
_THREAD_PX = 8


class BenchArena(composer.Arena):
    """The arena of the bench: all but the robot."""

    _mjcf_root: Any  # mjcf makes its attributes from MuJoCo's schema at run time

    def _build(self, name: str = "bench") -> None:
        root: Any = mjcf.from_path(str(ASSETS / "bench.xml"))
        root.model = name
        self._mjcf_root = root
        _, png = cv2.imencode(".png", printed()[..., ::-1])
        texture = root.asset.add(
            "texture", name="print", type="2d", file=mjcf.Asset(png.tobytes(), ".png")
        )
        material = root.asset.add("material", name="gauze", texture=texture, specular=0)
        for clip in CLIPS:
            body = root.worldbody.add("body", name=clip, mocap="true", pos=CENTRE_M)
            half = CLIP_M / 2
            body.add("geom", type="box", size=[half, half, 0.0015], rgba=[0.85, 0.5, 0.1, 1])
            body.add(
                "geom",
                type="cylinder",
                fromto=[0, 0, -0.0015, 0, 0, -CENTRE_M[2]],
                size=[0.003],
                rgba=[0.5, 0.5, 0.55, 1],
            )
        place = root.worldbody.add("body", name="place", pos=CENTRE_M)
        add_sheet(
            place,
            SHEET,
            MESH,
            MEMBRANE,
            SPARE_TRIANGLES,
            pinned=np.flatnonzero(CLIP_OF_VERTEX >= 0),
            vertex_mass_kg=MASS_KG / len(MESH.points_m),
            damping_s=DAMPING_S,
            material=material,
        )

    def camera(self, name: str) -> Any:
        """The MJCF element of one that stands in the world."""
        return self._mjcf_root.find("camera", name)


def printed() -> NDArray[np.uint8]:
    """(h, w, 3) RGB of the sheet: a weave, and the circle. Row 0 is at the top, +y."""
    ticks = (np.arange(_PRINT_PX) + 0.5) / _PRINT_PX * SIDE_M - SIDE_M / 2
    x, y = np.meshgrid(ticks, -ticks)
    threads = np.arange(_PRINT_PX) // (_THREAD_PX // 2) % 2
    weave = 12 * (threads[:, None] ^ threads[None, :])
    picture = np.array([238, 234, 222]) - weave[..., None]
    picture[np.abs(np.hypot(x, y) - RADIUS_M) < _LINE_M / 2] = (20, 60, 150)
    return picture.astype(np.uint8)
