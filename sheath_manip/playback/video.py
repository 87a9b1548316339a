"""Frames as an mp4 that browsers play."""

import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import SetupError

# VP9: free to encode, and in OpenCV's own build of FFmpeg, which has no encoder for H.264.
CODEC = "vp09"


def mp4(
    frames: Iterable[NDArray[np.uint8]],
    rate_hz: float,
    report: Callable[[int], None] = lambda _: None,
) -> bytes:
    """The video of (h, w, 3) RGB `frames` of one even size; `report` is told of each.

    Raises SetupError where this machine's OpenCV cannot encode it, or the disk of its temporary
    files has no room.
    """
    writer: cv2.VideoWriter | None = None
    count = 0
    # OpenCV writes to files only.
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "film.mp4"
        try:
            for number, frame in enumerate(frames):
                if writer is None:
                    height, width = frame.shape[:2]
                    code = cv2.VideoWriter.fourcc(*CODEC)
                    writer = cv2.VideoWriter(str(path), code, rate_hz, (width, height))
                    if not writer.isOpened():
                        raise SetupError(
                            f"OpenCV {cv2.__version__} here cannot encode {CODEC}; wanted a build "
                            "with FFmpeg, such as the opencv-python-headless of PyPI"
                        )
                writer.write(np.ascontiguousarray(frame[..., ::-1]))
                count = number + 1
                report(number)
        finally:
            if writer is not None:
                writer.release()
        _require_whole(path, count)
        return path.read_bytes()


def _require_whole(path: Path, count: int) -> None:
    """Raise SetupError where frames are missing: of a full disk OpenCV tells nothing."""
    reader = cv2.VideoCapture(str(path))
    try:
        found = int(reader.get(cv2.CAP_PROP_FRAME_COUNT)) if reader.isOpened() else 0
    finally:
        reader.release()
    if found != count:
        raise SetupError(
            f"the video has {max(found, 0)} of {count} frames; wanted room for it in "
            f"{path.parent.parent}: set TMPDIR to a folder with more"
        )
