"""A film of a page lasts as long as was filmed, whatever a picture took."""

import io

import numpy as np
import pytest
from PIL import Image

from tools.reel import RATE_HZ, WIDTH_PX, Reel


def jpeg(grey: int) -> bytes:
    file = io.BytesIO()
    Image.new("RGB", (140, 90), (grey, grey, grey)).save(file, "JPEG")
    return file.getvalue()


class Slow:
    """A page that takes its time, and is each time a shade lighter."""

    def __init__(self, clock: list[float], takes_s: float) -> None:
        self.clock, self.takes_s = clock, takes_s
        self.words: list[str] = []
        self.taken = 0

    def evaluate(self, _, words: str) -> None:
        self.words.append(words)

    def screenshot(self, **_) -> bytes:
        self.clock[0] += self.takes_s
        self.taken += 1
        return jpeg(20 * self.taken)

    def wait_for_timeout(self, ms: float) -> None:
        self.clock[0] += ms / 1000


@pytest.mark.parametrize(("takes_s", "pictures"), [(0.01, 8), (1.0, 2)])
def test_the_film_goes_as_the_clock_did(monkeypatch, takes_s, pictures):
    clock = [100.0]
    monkeypatch.setattr("tools.reel.time.monotonic", lambda: clock[0])
    page = Slow(clock, takes_s)
    reel = Reel(page)  # pyright: ignore[reportArgumentType]
    reel.roll(2.0, "words")
    assert page.words == ["words"]
    assert page.taken == pictures
    shown = list(reel.shown())
    assert len(shown) == 2.0 * RATE_HZ
    assert {frame.shape for frame in shown} == {(2 * round(90 * WIDTH_PX / 140 / 2), WIDTH_PX, 3)}
    shades = [int(frame.mean()) for frame in shown]
    assert shades == sorted(shades)
    assert len(np.unique(shades)) == pictures
