"""The frames of a film: the scene, who acts and why, and the score against its threshold."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from sheath_manip.exceptions import ParameterError
from sheath_manip.playback import palette
from sheath_manip.playback.film import Film
from sheath_manip.playback.labels import actor_label
from sheath_manip.playback.trace import Trace
from sheath_manip.support.calibration import REJECT_ALL
from sheath_manip.types import Actor, Outcome

Pictures = Callable[[int], NDArray[np.uint8]]
"""(h, w, 3) RGB of how the scene stands before a step, and at the number of steps after the last
one; all of one size"""

WIDTH_PX, TALLEST_PX = 720, 360
"""of a film, and of the picture in it"""
WORDS_PX, STRIP_PX, SCORE_PX, AXIS_PX = 36, 20, 96, 26
MARGIN_PX = 14
LARGE_PX, SMALL_PX = 20, 14
"""of letters"""
MOST_TICKS = 9
WHOLE = slice(None)


def seen(film: Film) -> Pictures:
    """Return what the cameras saw, side by side; raises ParameterError where there was none."""
    if not film.steps or not film.steps[0].observation.images:
        raise ParameterError(
            f"{film.info.task} was seen by no camera; wanted recorded images, or "
            "Task(picture=...): docs/own/task.md"
        )

    def picture(moment: int) -> NDArray[np.uint8]:
        return side_by_side(film.observation(moment).images)

    return picture


def side_by_side(images: Mapping[str, NDArray[np.uint8]]) -> NDArray[np.uint8]:
    """Return all images scaled to the height of the highest."""
    height = max(image.shape[0] for image in images.values())
    scaled = [
        cv2.resize(image, (round(image.shape[1] * height / image.shape[0]), height))
        for image in images.values()
    ]
    return np.concatenate(scaled, axis=1).astype(np.uint8)


def frames(
    trace: Trace,
    outcome: Outcome | None,
    pictures: Pictures,
    window: slice = WHOLE,
    moments: Iterable[int] | None = None,
) -> Iterator[NDArray[np.uint8]]:
    """(h, WIDTH_PX, 3) RGB of each step in `window`, all of one even height.

    Where the window reaches the end of an episode that is over, one frame more shows how it ended:
    the last frame is the last observation.

    Args:
        trace: the episode's T steps.
        outcome: None while the episode runs.
        pictures: of the moments 0 .. T.
        window: the steps that the time axis shows.
        moments: of the window, those to draw; None for all of them, one after the other.
    """
    first, stop, _ = window.indices(len(trace))
    ends = outcome is not None and stop == len(trace)
    below = _Below.drawn(trace, first, stop)
    for moment in range(first, stop + ends) if moments is None else moments:
        picture = _framed(pictures(moment))
        if moment < stop:
            actor, reason = trace.who_and_why(moment)
            words = f"{actor_label(actor, reason)}: {reason.value}"
            bar = _words(words, palette.turn(actor, reason), trace.time_s[moment])
        else:
            assert outcome is not None
            bar = _words(f"the end: {outcome.value}", palette.OUTCOME[outcome], _end_s(trace))
        yield np.concatenate([picture, bar, below.at(moment)])


def _framed(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """As large as there is room for, in the middle."""
    height, width = picture.shape[:2]
    scale = min(TALLEST_PX / height, WIDTH_PX / width)
    # Video wants even sides.
    size = (2 * round(width * scale / 2), 2 * round(height * scale / 2))
    how = cv2.INTER_AREA if scale < 1 else cv2.INTER_CUBIC
    framed = np.full((size[1], WIDTH_PX, 3), palette.PAPER, np.uint8)
    left = (WIDTH_PX - size[0]) // 2
    framed[:, left : left + size[0]] = cv2.resize(picture, size, interpolation=how)
    return framed


def _words(words: str, rgb: palette.Rgb, time_s: float) -> NDArray[np.uint8]:
    """Return a bar that says who acts and why, and when."""
    bar = Image.new("RGB", (WIDTH_PX, WORDS_PX), rgb)
    ink, middle = palette.readable_on(rgb), WORDS_PX / 2
    draw, font = ImageDraw.Draw(bar), ImageFont.load_default(LARGE_PX)
    draw.text((MARGIN_PX, middle), words, ink, font, "lm")
    draw.text((WIDTH_PX - MARGIN_PX, middle), f"{time_s:.1f} s", ink, font, "rm")
    return np.asarray(bar)


@dataclass(frozen=True, eq=False)
class _Below:
    """Who acts, the score and the time axis: the same in all frames but for what is past."""

    first: int
    columns: NDArray[np.float64]
    """(n + 1,) pixel at which each step of the window begins, and at which the last one ends"""
    ahead: NDArray[np.uint8]
    past: NDArray[np.uint8]

    @classmethod
    def drawn(cls, trace: Trace, first: int, stop: int) -> "_Below":
        columns = np.linspace(MARGIN_PX, WIDTH_PX - MARGIN_PX, stop - first + 1)
        strip = _strip(trace, first, columns)
        axis = _axis(trace, first, stop, columns)
        ahead, past = (
            np.concatenate([strip, _score(trace, first, stop, columns, rgb), axis])
            for rgb in (palette.PALE, palette.INK)
        )
        return cls(first, columns, ahead, past)

    def at(self, moment: int) -> NDArray[np.uint8]:
        """With a line at the moment: what was is dark, what comes is pale."""
        now = round(self.columns[moment - self.first])
        picture = np.concatenate([self.past[:, :now], self.ahead[:, now:]], axis=1)
        picture[: STRIP_PX + SCORE_PX, now - 1 : now + 1] = palette.INK
        return picture


def _strip(trace: Trace, first: int, columns: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Who acts and why: half as high where it is the policy, for those who see no colours."""
    strip = np.full((STRIP_PX, WIDTH_PX, 3), 255, np.uint8)
    edges = np.rint(columns).astype(int)
    for number, (left, right) in enumerate(pairwise(edges.tolist())):
        actor, reason = trace.who_and_why(first + number)
        top = STRIP_PX // 2 if actor is Actor.POLICY else 2
        strip[top:, left:right] = palette.turn(actor, reason)
    return strip


def _score(
    trace: Trace, first: int, stop: int, columns: NDArray[np.float64], rgb: palette.Rgb
) -> NDArray[np.uint8]:
    panel = np.full((SCORE_PX, WIDTH_PX, 3), 255, np.uint8)
    score, threshold = trace.score[first:stop], trace.threshold[first:stop]
    both = np.concatenate([score, threshold])
    known = both[np.abs(both) < REJECT_ALL]
    if not known.size:
        return panel
    low, high = float(known.min()), float(known.max())
    scale = (SCORE_PX - SMALL_PX - 14) / max(high - low, 1e-12)
    middles = (columns[:-1] + columns[1:]) / 2
    for values, colour, thick in ((threshold, palette.GREY, 1), (score, rgb, 2)):
        # A score without a bound lies at the edge of the panel.
        heights = SMALL_PX + 8 + (high - np.clip(values, low, high)) * scale
        points = np.stack([middles, heights], axis=1)
        points = np.rint(points[np.isfinite(points).all(axis=1)]).astype(np.int32)
        cv2.polylines(panel, [points[:, None]], False, colour, thick, cv2.LINE_AA)
    picture = Image.fromarray(panel)
    draw, font = ImageDraw.Draw(picture), ImageFont.load_default(SMALL_PX)
    draw.text((MARGIN_PX, 2), "score, and its threshold (thin)", palette.GREY, font)
    return np.asarray(picture)


def _axis(trace: Trace, first: int, stop: int, columns: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return the time axis, with ticks at round numbers of seconds."""
    picture = Image.new("RGB", (WIDTH_PX, AXIS_PX), "white")
    draw, font = ImageDraw.Draw(picture), ImageFont.load_default(SMALL_PX)
    draw.line([(MARGIN_PX, 0), (WIDTH_PX - MARGIN_PX, 0)], palette.GREY)
    times = np.append(trace.time_s[first:stop], _end_s(trace, stop))
    for tick in round_times(float(times[0]), float(times[-1])):
        x = float(np.interp(tick, times, columns))
        draw.line([(x, 0), (x, 5)], palette.GREY)
        draw.text((x, 7), f"{tick:g} s", palette.GREY, font, "mt")
    return np.asarray(picture)


def round_times(first_s: float, last_s: float) -> list[float]:
    """Return times between both that are 1, 2 or 5 times a power of ten apart, and not many."""
    power = 10.0 ** np.floor(np.log10(max(last_s - first_s, 1e-3) / MOST_TICKS))
    step = next(s for m in (1, 2, 5, 10) if (last_s - first_s) / (s := m * power) <= MOST_TICKS)
    numbers = range(int(np.ceil(first_s / step - 1e-9)), int(np.floor(last_s / step + 1e-9)) + 1)
    return [round(number * step, 9) for number in numbers]


def _end_s(trace: Trace, stop: int | None = None) -> float:
    """When the last step before `stop` was over."""
    times = trace.time_s[:stop]
    return float(2 * times[-1] - times[-2]) if len(times) > 1 else float(times[-1])
