"""What the browser shows of one moment: the scene, the panel and the support picture together."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import viser
from numpy.typing import NDArray

from sheath_manip.dashboard.panel import Panel
from sheath_manip.dashboard.scene import SceneView
from sheath_manip.dashboard.support_picture import SupportPicture, Track, ground_of
from sheath_manip.dashboard.tally import Figures, Scored
from sheath_manip.support.plane import PlaneLevels, plane_levels
from sheath_manip.types import Actor, SceneGeom, TaskSpec


@dataclass(frozen=True, eq=False)
class Moment:
    """All that one drawing shows."""

    scene: tuple[SceneGeom, ...]
    """the same object throughout an episode"""
    body_poses: NDArray[np.float64]
    """(b, 7)"""
    figures: Figures
    scores: tuple[Scored, ...]
    """of the latest steps"""
    trail: tuple[tuple[float, float, Actor], ...]
    """x and y (metres, in `TaskSpec.plane`) and who acted, of the latest steps"""
    images: Mapping[str, NDArray[np.uint8]]
    """(h, w, 3) RGB by camera"""
    training: NDArray[np.float64] | None
    """(n, 2) metres in `TaskSpec.plane`; the same object until the policy is fitted anew"""


class Page:
    """Draws moments; what did not change since the last one is kept."""

    def __init__(
        self, server: viser.ViserServer, spec: TaskSpec, on_pause: Callable[[], bool]
    ) -> None:
        self.panel = Panel(server, spec, on_pause)
        self._server = server
        self._has_plane = spec.plane is not None
        self._scene = SceneView(server)
        self._levels: PlaneLevels | None = None
        self._levels_of: NDArray[np.float64] | None = None
        self._support: SupportPicture | None = None
        self._support_of: tuple[object, object] = (None, None)

    @property
    def watched(self) -> bool:
        """Whether any browser shows the page."""
        return bool(self._server.get_clients())

    def draw(self, moment: Moment) -> None:
        """Show `moment`, in about the time that its images take to encode."""
        with self._server.atomic():
            self._scene.build(moment.scene, moment.body_poses)
            self._scene.move(moment.body_poses)
            self.panel.show_figures(moment.figures)
            self.panel.show_scores(moment.scores)
            self.panel.show_cameras(moment.images)
        if self._has_plane:
            self._draw_support(moment)

    def _draw_support(self, moment: Moment) -> None:
        if moment.training is not self._levels_of:
            self._levels = None if moment.training is None else plane_levels(moment.training)
            self._levels_of = moment.training
        scene = self._scene.shown
        if self._support_of[0] is not scene or self._support_of[1] is not moment.training:
            ground = ground_of(scene, moment.body_poses)
            drawable = ground is not None or self._levels is not None
            training = np.zeros((0, 2)) if moment.training is None else moment.training
            self._support = SupportPicture(ground, training, self._levels) if drawable else None
            self._support_of = (scene, moment.training)
        if self._support is not None:
            positions = np.array([(x, y) for x, y, _ in moment.trail]).reshape(-1, 2)
            track = Track(positions, tuple(actor for _, _, actor in moment.trail))
            self.panel.show_support(self._support.draw(track), self._levels is not None)
