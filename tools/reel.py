"""Pictures of a page in headless Chromium, taken one after the other, with words below them."""

import io
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Page

RATE_HZ = 4.0
WIDTH_PX = 980
QUALITY = 90
"""of the pictures on their way"""
SAY = """text => {
  let box = document.getElementById('film-words');
  if (!box) {
    box = document.createElement('div');
    box.id = 'film-words';
    box.style.cssText = 'position:fixed;left:0;right:0;bottom:0;z-index:100000;padding:.55em 1em;' +
      'background:#22272e;color:white;font:21px/1.4 sans-serif;text-align:center;' +
      'pointer-events:none';
    document.body.append(box);
  }
  box.textContent = text;
}"""


@dataclass
class Reel:
    """Takes pictures of the page for as long as it is told, with words below them."""

    page: Page
    frames: list[tuple[float, bytes]] = field(default_factory=list)
    """when, in the film's own time, and the JPEG"""
    clock_s: float = 0.0

    def roll(self, seconds: float, words: str = "", each: Callable[[], Any] = lambda: None) -> None:
        """Film for so long; `each` is called before each picture."""
        if words:
            self.page.evaluate(SAY, words)
        ends_s = self.clock_s + seconds
        while self.clock_s < ends_s:
            began_s = time.monotonic()
            each()
            picture = self.page.screenshot(type="jpeg", quality=QUALITY)
            self.frames.append((self.clock_s, picture))
            self.page.wait_for_timeout(max(0, 1000 / RATE_HZ - 1000 * (time.monotonic() - began_s)))
            self.clock_s += time.monotonic() - began_s

    def roll_until(self, there: Callable[[], bool], words: str, most_s: float) -> None:
        """Film until something is so, or for `most_s`."""
        ends_s = self.clock_s + most_s
        while not there() and self.clock_s < ends_s:
            self.roll(0.1, words)

    def shown(self) -> Iterator[NDArray[np.uint8]]:
        """Yield what is to be seen at each moment of the film."""
        place = -1
        image = np.empty(0, np.uint8)
        for number in range(int(RATE_HZ * self.clock_s)):
            newest = place
            while newest + 1 < len(self.frames) and self.frames[newest + 1][0] <= number / RATE_HZ:
                newest += 1
            if newest != place:
                place, image = newest, _scaled(self.frames[newest][1])
            yield image


def _scaled(jpeg: bytes) -> NDArray[np.uint8]:
    picture = Image.open(io.BytesIO(jpeg)).convert("RGB")
    # Of even size, as a video wants it.
    height = 2 * round(picture.height * WIDTH_PX / picture.width / 2)
    return np.asarray(picture.resize((WIDTH_PX, height), Image.Resampling.LANCZOS))
