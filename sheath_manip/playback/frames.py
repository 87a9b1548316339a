"""The frames of a film: what was seen, who acted and why, and the score against its threshold."""

from collections.abc import Callable, Iterator, Mapping

import cv2
import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.playback import palette
from sheath_manip.playback.film import Film
from sheath_manip.playback.labels import actor_label
from sheath_manip.playback.trace import Trace

Pictures = Callable[[int], NDArray[np.uint8]]
"""(h, w, 3) RGB of how the scene stands before a step, all of one size"""

HEIGHT_PX, WIDEST_PX = 288, 640
"""of the picture"""
WORDS_PX, STRIP_PX, SCORE_PX = 26, 14, 64
MARGIN_PX = 10
FONT = cv2.FONT_HERSHEY_DUPLEX
WHITE = (255, 255, 255)


def seen(film: Film) -> Pictures:
    """Return what the cameras saw, side by side; raises ParameterError where there was none."""
    if not film.steps or not film.steps[0].observation.images:
        raise ParameterError(
            f"{film.info.task} was seen by no camera; wanted recorded images, or a `picture` in "
            "the task's entry"
        )

    def picture(step: int) -> NDArray[np.uint8]:
        return _side_by_side(film.steps[step].observation.images)

    return picture


def frames(film: Film, pictures: Pictures) -> Iterator[NDArray[np.uint8]]:
    """(h, w, 3) RGB, one a step, all of one even size."""
    trace = film.trace.so_far()
    below: NDArray[np.uint8] | None = None
    for step in range(len(film)):
        picture = _fitted(pictures(step))
        width = picture.shape[1]
        if below is None:
            below = np.concatenate([_strip(trace, width), _score(trace, width)])
        yield np.concatenate([picture, _words(film, step, width), _marked(below, step, trace)])


def _side_by_side(images: Mapping[str, NDArray[np.uint8]]) -> NDArray[np.uint8]:
    height = max(image.shape[0] for image in images.values())
    scaled = [
        cv2.resize(image, (round(image.shape[1] * height / image.shape[0]), height))
        for image in images.values()
    ]
    return np.concatenate(scaled, axis=1).astype(np.uint8)


def _fitted(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Scaled to the film's height, or to its largest width."""
    height, width = picture.shape[:2]
    scale = min(HEIGHT_PX / height, WIDEST_PX / width)
    # Video wants even sides.
    size = (2 * round(width * scale / 2), 2 * round(height * scale / 2))
    how = cv2.INTER_AREA if scale < 1 else cv2.INTER_CUBIC
    return np.asarray(cv2.resize(picture, size, interpolation=how), np.uint8)


def _words(film: Film, step: int, width: int) -> NDArray[np.uint8]:
    trace = film.trace.so_far()
    actor, reason = trace.who_and_why(step)
    bar = np.full((WORDS_PX, width, 3), palette.turn(actor, reason), np.uint8)
    words = f"{actor_label(actor, reason)}: {reason.value}"
    if step + 1 == len(film) and film.outcome is not None:
        bar[:] = palette.OUTCOME[film.outcome]
        words = film.outcome.value
    place = (MARGIN_PX, WORDS_PX - 9)
    cv2.putText(bar, words, place, FONT, 0.45, WHITE, 1, cv2.LINE_AA)
    seconds = f"{trace.time_s[step]:.1f} s"
    place = (width - MARGIN_PX - 9 * len(seconds), WORDS_PX - 9)
    cv2.putText(bar, seconds, place, FONT, 0.45, WHITE, 1, cv2.LINE_AA)
    return bar


def _columns(trace: Trace, width: int) -> NDArray[np.intp]:
    """(width,) the step that each column of pixels stands for."""
    return np.arange(width) * len(trace) // width


def _strip(trace: Trace, width: int) -> NDArray[np.uint8]:
    """Who acted and why, over the whole episode."""
    colours = [palette.turn(*trace.who_and_why(step)) for step in _columns(trace, width)]
    return np.repeat(np.array([colours], np.uint8), STRIP_PX, axis=0)


def _score(trace: Trace, width: int) -> NDArray[np.uint8]:
    panel = np.full((SCORE_PX, width, 3), 255, np.uint8)
    both = np.concatenate([trace.score, trace.threshold])
    known = both[np.isfinite(both)]
    if not known.size:
        return panel
    low, high = float(known.min()), float(known.max())
    scale = (SCORE_PX - 8) / max(high - low, 1e-12)
    x = (np.arange(len(trace)) + 0.5) * width / len(trace)
    for values, colour in ((trace.threshold, palette.GREY), (trace.score, palette.INK)):
        points = np.stack([x, 4 + (high - values) * scale], axis=1)
        points = np.rint(points[np.isfinite(points).all(axis=1)]).astype(np.int32)
        cv2.polylines(panel, [points[:, None]], False, colour, 1, cv2.LINE_AA)
    return panel


def _marked(below: NDArray[np.uint8], step: int, trace: Trace) -> NDArray[np.uint8]:
    """With a line at the step."""
    marked = below.copy()
    column = min(round((step + 0.5) * below.shape[1] / len(trace)), below.shape[1] - 2)
    marked[:, column : column + 2] = palette.INK
    return marked
