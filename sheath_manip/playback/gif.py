"""Frames as an animated GIF, which a README shows without a player."""

import io
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image

COLOURS = 96
PAUSE_MS = 1200
"""on the last frame, before the film begins anew"""


def gif(frames: Sequence[NDArray[np.uint8]], frame_ms: float, typical: Sequence[int]) -> bytes:
    """Return the GIF of (h, w, 3) RGB `frames` of one size.

    Args:
        frames: at least one.
        frame_ms: how long each is shown, to 10 ms.
        typical: places of frames that together show all colours.
    """
    # One palette for all frames, or their colours would flicker.
    palette = limited(Image.fromarray(np.concatenate([frames[i] for i in typical])), COLOURS)
    pictures = [limited(Image.fromarray(frame), COLOURS, palette) for frame in frames]
    file = io.BytesIO()
    pictures[0].save(
        file,
        format="GIF",
        save_all=True,
        append_images=pictures[1:],
        duration=[10 * round(frame_ms / 10)] * (len(pictures) - 1) + [PAUSE_MS],
        loop=0,
        optimize=False,
    )
    return file.getvalue()


def limited(picture: Image.Image, colours: int, palette: Image.Image | None = None) -> Image.Image:
    """Return `picture` in its own best `colours`, or in those of `palette`."""
    # Coverage keeps what is small and bright, such as a car; k-means then what is large.
    method, refinements = Image.Quantize.MAXCOVERAGE, 3
    return picture.quantize(colours, method, refinements, palette, Image.Dither.NONE)
