"""One intervention as a short film that a README can show."""

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from sheath_manip.experiments.figures.intervention import Intervention
from sheath_manip.experiments.figures.style import EXPERT, PALE, POLICY, limited
from sheath_manip.outputs import written_aside
from sheath_manip.support.calibration import REJECT_ALL
from sheath_manip.types import Actor

HEIGHT_PX = 288
FRAME_PX = 8
BELOW_PX = 84
MARGIN_PX = 14
SLOWER = 2.0
"""than it was: at 10 Hz an intervention is over before one has looked"""
PAUSE_MS = 900
"""on the last frame, before the film begins anew"""
COLOURS = 80
INK_RGB = (34, 39, 46)
FONT = cv2.FONT_HERSHEY_DUPLEX


def film(shown: Intervention, path: Path) -> None:
    """An animated GIF of the intervention and its surroundings, at half speed."""
    window = range(*shown.window.indices(len(shown.episode.steps)))
    images = shown.view.pictures(shown.episode, window)
    drawn = [_frame(shown, index, image) for index, image in zip(window, images, strict=True)]
    # One palette for all frames, or their colours would flicker; these two show both actors.
    typical = np.concatenate([drawn[0], drawn[shown.start - window.start]])
    palette = limited(Image.fromarray(typical), COLOURS)
    frames = [limited(Image.fromarray(picture), COLOURS, palette) for picture in drawn]
    frame_ms = round(1000 * SLOWER / shown.episode.info.control_rate_hz)
    with written_aside(path) as aside:
        frames[0].save(
            aside,
            format="GIF",
            save_all=True,
            append_images=frames[1:],
            duration=[frame_ms] * (len(frames) - 1) + [PAUSE_MS],
            loop=0,
            optimize=False,
        )


def _frame(shown: Intervention, index: int, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """(h, w, 3) RGB: the camera in the colour of who acts, below it the score up to now."""
    step = shown.episode.steps[index]
    expert = step.decision.actor is not Actor.POLICY
    colour = _rgb(EXPERT if expert else POLICY)
    width_px = round(HEIGHT_PX * image.shape[1] / image.shape[0])
    size = (width_px, HEIGHT_PX)
    resized = cv2.resize(image, size, interpolation=cv2.INTER_CUBIC)
    whole, across = HEIGHT_PX + 2 * FRAME_PX, width_px + 2 * FRAME_PX
    picture = np.full((whole + BELOW_PX, across, 3), 255, np.uint8)
    picture[:whole] = colour
    picture[FRAME_PX : -FRAME_PX - BELOW_PX, FRAME_PX:-FRAME_PX] = resized
    words = "expert acts" if expert else "policy acts"
    place = (MARGIN_PX, whole + 20)
    cv2.putText(picture, words, place, FONT, 0.5, colour, 1, cv2.LINE_AA)
    place = (across - 152, whole + 20)
    cv2.putText(picture, "support score", place, FONT, 0.5, INK_RGB, 1, cv2.LINE_AA)
    _draw_score(picture[whole + 28 : -6], shown, index)
    return picture


def _draw_score(panel: NDArray[np.uint8], shown: Intervention, now: int) -> None:
    """Draw threshold, and score up to `now`, into the view `panel`."""
    height, width, _ = panel.shape
    steps = shown.episode.steps[shown.window]
    scores = np.array([step.decision.score for step in steps])
    thresholds = np.array([step.decision.threshold for step in steps])
    both = np.concatenate([scores, thresholds])
    drawable = both[np.abs(both) < REJECT_ALL]
    low, high = (drawable.min(), drawable.max()) if len(drawable) else (0.0, 1.0)
    x = np.linspace(MARGIN_PX, width - MARGIN_PX, len(steps))
    scale = (height - 8) / max(high - low, 1e-12)

    def line(values: NDArray, colour: tuple[int, int, int], upto: int, thick: int) -> None:
        # A score without a bound lies at the edge of the panel.
        y = 4 + (high - np.clip(values, low, high)) * scale
        points = np.stack([x, y], 1)[:upto]
        points = np.rint(points[np.isfinite(points).all(1)]).astype(np.int32)
        cv2.polylines(panel, [points[:, None]], False, colour, thick, cv2.LINE_AA)

    line(thresholds, _rgb(PALE), len(steps), 2)
    line(scores, INK_RGB, now - shown.window.start + 1, 2)


def _rgb(colour: str) -> tuple[int, int, int]:
    red, green, blue = bytes.fromhex(colour[1:])
    return red, green, blue
