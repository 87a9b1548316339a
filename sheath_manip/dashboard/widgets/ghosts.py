"""Widgets in the scene: where the policy's proposal would lead in a second, and the expert's."""

from dataclasses import replace

import numpy as np
import viser

from sheath_manip.dashboard.explainer import Explainer
from sheath_manip.dashboard.ghost import Ghost
from sheath_manip.dashboard.scene import WORLD, add_geom
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.playback import palette
from sheath_manip.types import Actor, SceneGeom

OPACITY = 0.45
THICKNESS_PX = 5.0
LIFT_SHARE = 0.004
"""of the first view's radius by which a way is lifted, so that the ground does not hide it"""


class Ghosts:
    """The bodies that a proposal would move, translucent, and the way of the tool."""

    def __init__(self, context: WidgetContext, explainer: Explainer) -> None:
        self._scene, self._explainer = context.viser.scene, explainer
        view = context.spec.first_view
        self._lift_m = 0.0 if view is None else LIFT_SHARE * view.radius_m
        self._nodes: list[viser.SceneNodeHandle] = []
        self._shown: object = ()

    def draw(self, snapshot: Snapshot) -> None:
        """Show the ghosts of the moment that is explained, none for any other."""
        found = self._explainer.ask(snapshot)
        ghosts = () if found is None else found.ghosts
        if ghosts is self._shown:
            return
        self._shown = ghosts
        for node in self._nodes:
            node.remove()
        self._nodes = []
        if found is not None:
            actors = Actor.POLICY, found.explanation.moment.other
            for actor, ghost in zip(actors, ghosts, strict=False):
                self._haunt(actor, ghost, snapshot.scene)

    def _haunt(self, actor: Actor, ghost: Ghost, scene: tuple[SceneGeom, ...]) -> None:
        name, colour = f"{WORLD}/ghost_{actor.value}", palette.ACTOR[actor]
        root = self._scene.add_frame(name, show_axes=False)
        self._nodes.append(root)
        red, green, blue = (each / 255 for each in colour)
        for body in ghost.bodies.tolist():
            frame = self._scene.add_frame(f"{name}/{body}", show_axes=False)
            frame.position, frame.wxyz = ghost.pose.bodies[body, :3], ghost.pose.bodies[body, 3:]
            for index, geom in enumerate(scene):
                if geom.body == body and geom.shape != "picture":
                    pale = replace(geom, rgba=(red, green, blue, OPACITY))
                    add_geom(self._scene, f"{name}/{body}/{index}", pale)
        way = ghost.way_m + np.array([0.0, 0.0, self._lift_m])
        if len(way) > 1 and np.isfinite(way).all():
            points = np.stack([way[:-1], way[1:]], axis=1).astype(np.float32)
            colours = np.broadcast_to(
                np.array(palette.linear(colour), np.uint8), points.shape
            ).copy()
            self._scene.add_line_segments(
                f"{name}/way", points, colours, thickness=THICKNESS_PX, thickness_units="screen"
            )
