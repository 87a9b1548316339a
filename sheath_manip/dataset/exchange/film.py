"""Frames of a film that somebody else encoded, read by FFmpeg (PyAV) from the file alone.

FFmpeg guesses the format of what it opens, and some formats name other files or addresses to read
from: so the format is given, the file is opened here, and the codecs stand on a list.
"""

from contextlib import closing
from typing import IO

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.exchange.limits import Limits
from sheath_manip.dataset.extras import needs
from sheath_manip.exceptions import StoreError

with needs("lerobot-data", "av"):
    import av

CODECS = ("av1", "h264", "hevc", "mpeg4", "vp9")
FORMAT = "mp4"
EDGE_PX = 128
"""by which a codec's blocks may make a frame larger than it shows"""


def frames(
    what: str,
    file: IO[bytes],
    first: int,
    shape: tuple[int, int, int],
    rate_hz: float,
    limits: Limits,
) -> NDArray[np.uint8]:
    """(T, h, w, 3) RGB of the frames `first` … of a film, for a `shape` of (T, h, w).

    The frames are those whose times are nearest, at `rate_hz` from the film's beginning. Raises
    StoreError where the film has another size or codec, or lacks one of the frames.
    """
    length, height, width = shape
    limits.require_memory(what, length * height * width * 3)
    images, found = np.empty((*shape, 3), np.uint8), np.zeros(length, bool)
    with closing(av.open(file, "r", format=FORMAT, metadata_errors="replace")) as container:
        if not container.streams.video:
            raise StoreError(f"{what} is no film")
        stream = container.streams.video[0]
        context = stream.codec_context
        name = context.codec.canonical_name
        if name not in CODECS or (context.height, context.width) != (height, width):
            raise StoreError(
                f"{what} is {name} of {context.height}x{context.width} pixels; wanted "
                f"{height}x{width} in one of {', '.join(CODECS)}"
            )
        context.options = {"max_pixels": str((height + EDGE_PX) * (width + EDGE_PX))}
        if first:
            before = round((first - 0.5) / rate_hz / float(stream.time_base or 1))
            container.seek(before, stream=stream)
        for frame in container.decode(stream):
            limits.require_time()
            if frame.time is None or (frame.height, frame.width) != (height, width):
                raise StoreError(f"a frame of {what} has no time, or another size than the film")
            place = round(frame.time * rate_hz) - first
            if place >= length:
                break
            if place >= 0:
                images[place] = frame.to_ndarray(format="rgb24")
                found[place] = True
    if not found.all():
        raise StoreError(
            f"{what} lacks {length - found.sum()} of the {length} frames from {first} on"
        )
    return images
