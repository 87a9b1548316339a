"""The support in the task's plane, and where the robot is in it."""

import numpy as np

from sheath_manip.dashboard import palette
from sheath_manip.dashboard.markup import TEXT, caption, note
from sheath_manip.dashboard.moment import Moment
from sheath_manip.dashboard.part import Desk
from sheath_manip.dashboard.support_picture import SupportPicture, Track, ground_of
from sheath_manip.support.plane import NUS, PlaneLevels, plane_levels
from sheath_manip.types import Actor, TaskSpec

NO_PLANE = "This task has no natural plane to draw its support in."
NO_TRAINING = "The support appears here with the first training states."


class PlaneSupport:
    """Training positions, level sets and the trail, as a picture."""

    def __init__(self, desk: Desk) -> None:
        gui, spec = desk.viser.gui, desk.spec
        self._has_plane = spec.plane is not None
        gui.add_html(caption("Support", _plane(spec)))
        self._image = gui.add_image(np.zeros((1, 1, 3), np.uint8), jpeg_quality=85, visible=False)
        self._note = gui.add_html(note(NO_TRAINING if spec.plane else NO_PLANE))
        self._levels: PlaneLevels | None = None
        self._levels_of: object = None
        self._picture: SupportPicture | None = None
        self._picture_of: tuple[object, object] = (None, None)

    def draw(self, moment: Moment) -> None:
        """Draw the trail on what stays as it is."""
        if not self._has_plane:
            return
        if moment.training is not self._levels_of:
            self._levels = None if moment.training is None else plane_levels(moment.training)
            self._levels_of = moment.training
        if self._picture_of[0] is not moment.scene or self._picture_of[1] is not moment.training:
            ground = ground_of(moment.scene, moment.body_poses)
            drawable = ground is not None or self._levels is not None
            training = np.zeros((0, 2)) if moment.training is None else moment.training
            self._picture = SupportPicture(ground, training, self._levels) if drawable else None
            self._picture_of = (moment.scene, moment.training)
        if self._picture is not None:
            positions = np.array([(x, y) for x, y, _ in moment.trail]).reshape(-1, 2)
            track = Track(positions, tuple(actor for _, _, actor in moment.trail))
            self._image.image = self._picture.draw(track)
            self._image.visible = True
            self._note.content = _legend() if self._levels is not None else note(NO_TRAINING)


def _plane(spec: TaskSpec) -> str:
    """The plane's features without the unit that ends their names."""
    if spec.plane is None:
        return ""
    x, y = (name.removesuffix("_m") for name in spec.plane)
    return f"over {x} and {y} (m)"


def _legend() -> str:
    nus = ", ".join(map(str, NUS))
    trail = " and ".join(
        f'<b style="color:{palette.css(palette.ACTOR[actor])}">{actor.value}</b>' for actor in Actor
    )
    return (
        f'<div style="{TEXT}">trail of {trail} <span style="opacity:.6">· dots: training states · '
        f"yellow: support at ν = {nus}</span></div>"
    )
