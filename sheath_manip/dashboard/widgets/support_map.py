"""The support as a map: training states, level sets, and the present state moving in it."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dashboard.chart import chart_of
from sheath_manip.dashboard.markup import TEXT, caption, coloured, note
from sheath_manip.dashboard.rate_limiter import RateLimiter
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.support_picture import SupportPicture, Track, ground_of
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.playback import palette
from sheath_manip.playback.trace import Trace
from sheath_manip.support.plane import NUS, PlaneLevels, plane_levels
from sheath_manip.types import ACTORS
from sheath_manip.types.samples import Samples

TRAIL_STEPS = 300
RATE_HZ = 6.0
NO_TRAINING = "The support appears here with the first training states."


class SupportMap:
    """A map of the support in the task's plane, on its ground.

    Where the task has no plane, a projection of what is observed takes its place.
    """

    def __init__(self, context: WidgetContext) -> None:
        gui, spec = context.viser.gui, context.spec
        self._has_ground = spec.plane is not None
        self._chart = chart_of(spec)
        gui.add_html(caption("Support", self._chart.title))
        self._image = gui.add_image(np.zeros((1, 1, 3), np.uint8), jpeg_quality=85, visible=False)
        self._note = gui.add_html(note(NO_TRAINING))
        self._limiter = RateLimiter(RATE_HZ)
        self._training: Samples | None = None
        self._positions = np.zeros((0, 2))
        self._levels: PlaneLevels | None = None
        self._picture: SupportPicture | None = None
        self._picture_of: tuple[object, object] = (None, None)
        self._track = np.zeros((0, 2))
        self._track_of: object = None

    def draw(self, snapshot: Snapshot) -> None:
        """Draw the trail on what stays as it is."""
        if snapshot.training is not self._training and snapshot.training is not None:
            self._positions = self._chart.fit(snapshot.training)
            self._levels = plane_levels(
                self._positions, bandwidth_factor=self._chart.bandwidth_factor
            )
            self._training = snapshot.training
            self._track_of = None
        if self._picture_of[0] is not snapshot.scene or self._picture_of[1] is not self._training:
            ground = ground_of(snapshot.scene, snapshot.pose) if self._has_ground else None
            drawable = ground is not None or self._levels is not None
            self._picture = (
                SupportPicture(ground, self._positions, self._levels) if drawable else None
            )
            self._picture_of = (snapshot.scene, self._training)
        if self._picture is not None and self._limiter.should_draw(snapshot):
            self._image.image = self._picture.draw(self._track_until(snapshot))
            self._image.visible = True
            self._note.content = (
                _legend(snapshot.trace) if self._levels is not None else note(NO_TRAINING)
            )

    def _track_until(self, snapshot: Snapshot) -> Track:
        shown = slice(max(snapshot.at + 1 - TRAIL_STEPS, 0), snapshot.at + 1)
        actors = tuple(ACTORS[place] for place in snapshot.trace.actor[shown])
        return Track(self._places(snapshot)[shown], actors)

    def _places(self, snapshot: Snapshot) -> NDArray[np.float64]:
        """(n, 2) of the shown episode's steps: each is placed once."""
        if self._track_of is not snapshot.info:
            self._track, self._track_of = np.zeros((0, 2)), snapshot.info
        new = [step.observation for step in snapshot.steps[len(self._track) : snapshot.at + 1]]
        if new:
            self._track = np.concatenate([self._track, self._chart.places(new)])
        return self._track


def _legend(trace: Trace) -> str:
    nus = ", ".join(map(str, NUS))
    trail = ", ".join(
        f"{coloured('━', palette.ACTOR[actor])} {actor.value}"
        for actor in (ACTORS[place] for place in np.unique(trace.actor))
    )
    return (
        f'<div style="{TEXT}">trail of {trail} <span style="opacity:.6">· dots: training states · '
        f"yellow: support at ν = {nus}</span></div>"
    )
