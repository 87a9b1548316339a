"""A widget in the scene: what deforms."""

import numpy as np
import viser

from sheath_manip.dashboard.scene import WORLD
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext


class Surfaces:
    """Surfaces in the scene: one mesh each, its vertices and faces changed as they are."""

    def __init__(self, context: WidgetContext) -> None:
        self._scene = context.viser.scene
        self._meshes: list[viser.MeshHandle] = []

    def draw(self, snapshot: Snapshot) -> None:
        """Show the snapshot's surfaces."""
        surfaces = snapshot.pose.surfaces
        while len(self._meshes) > len(surfaces):
            self._meshes.pop().remove()
        for index, surface in enumerate(surfaces):
            if index == len(self._meshes):
                red, green, blue = (round(255 * channel) for channel in surface.rgb)
                mesh = self._scene.add_mesh_simple(
                    f"{WORLD}/surfaces/{index}",
                    surface.vertices_m,
                    surface.faces,
                    color=(red, green, blue),
                    side="double",
                )
                self._meshes.append(mesh)
                continue
            mesh = self._meshes[index]
            mesh.vertices = surface.vertices_m
            faces = surface.faces.astype(np.uint32)
            if mesh.faces.shape != faces.shape or (mesh.faces != faces).any():
                mesh.faces = faces
