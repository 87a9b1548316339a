"""Small pictures of moments: some frames around each side by side, made once and kept."""

import hashlib
import uuid
from contextlib import suppress
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from sheath_manip.dashboard.catalog import EpisodeCatalog
from sheath_manip.dataset.archive import Signature
from sheath_manip.dataset.beside import THUMBNAILS
from sheath_manip.dataset.glimpse import glimpses
from sheath_manip.dataset.places import archive_path
from sheath_manip.dataset.rooted_files import is_folder, read_inside
from sheath_manip.exceptions import StoreError
from sheath_manip.playback.frames import side_by_side

FRAMES, MIDDLE = 8, 4
"""in a strip, and the place of the moment itself among them"""
APART_S = 0.3
"""between two frames"""
WIDEST_PX, TALLEST_PX = 280, 168
"""of a frame"""
_QUALITY = 82
_MOST_BYTES = 1 << 20
_SCHEMA = 1
"""Raise it whenever the same moment gives another picture."""
_JPEG = b"\xff\xd8", b"\xff\xd9"
"""how a whole one begins and ends"""


class Thumbnails:
    """Makes strips of the episodes of a catalog; those of a directory lie in it afterwards."""

    def __init__(self, catalog: EpisodeCatalog) -> None:
        self._catalog = catalog

    def strip(self, place: int, step: int) -> bytes:
        """Return FRAMES frames around a step, side by side as a JPEG; empty without a camera.

        Frames before the first step and after the last are those. Raises ParameterError where there
        is no such episode, and StoreError where it is damaged.
        """
        reader, name = self._catalog.source(place)
        summary = self._catalog.summary(place)
        step = min(max(step, 0), summary.length - 1)
        file = _kept_as(reader.folder, name, step)
        kept = b"" if file is None else _read(file)
        if kept:
            return kept
        apart = max(1, round(APART_S * summary.info.control_rate_hz))
        steps = [
            min(max(step + apart * (number - MIDDLE), 0), summary.length - 1)
            for number in range(FRAMES)
        ]
        seen = glimpses(reader, name, steps)
        if not seen[0]:
            return b""
        frames = [_small(side_by_side(images)) for images in seen]
        made, coded = cv2.imencode(
            ".jpg",
            np.concatenate(frames, axis=1)[..., ::-1],
            [cv2.IMWRITE_JPEG_QUALITY, _QUALITY],
        )
        if not made:
            raise StoreError(f"{name}: the images of step {step} make no JPEG; wanted RGB of uint8")
        if file is not None:
            _keep(file, coded.tobytes())
        return coded.tobytes()


def _small(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    height, width = picture.shape[:2]
    scale = min(TALLEST_PX / height, WIDEST_PX / width)
    how = cv2.INTER_AREA if scale < 1 else cv2.INTER_CUBIC
    size = max(1, round(width * scale)), max(1, round(height * scale))
    return np.asarray(cv2.resize(picture, size, interpolation=how), np.uint8)


def _kept_as(folder: Path | None, name: str, step: int) -> Path | None:
    """The file of a strip, another one as soon as the episode is another; None where none is kept.

    Of an episode in a folder of its own nobody can say at once whether it has changed.
    """
    if folder is None:
        return None
    try:
        at = Signature.of(archive_path(folder, name).lstat())
    except OSError:
        return None
    key = hashlib.sha256(f"{_SCHEMA} {at} {name} {step}".encode()).hexdigest()[:32]
    return folder / THUMBNAILS / f"{key}.jpg"


def _read(file: Path) -> bytes:
    try:
        content = read_inside(file.parent.parent, f"{THUMBNAILS}/{file.name}", _MOST_BYTES)
    except OSError:
        return b""
    return content if content.startswith(_JPEG[0]) and content.endswith(_JPEG[1]) else b""


def _keep(file: Path, content: bytes) -> None:
    """Where there is no room, or nothing may be written, it is made anew the next time."""
    aside = file.with_name(f".tmp-{uuid.uuid4().hex}")
    with suppress(OSError):
        file.parent.mkdir(exist_ok=True)
        # A link in its place leads nowhere that is ours.
        if not is_folder(file.parent):
            return
        try:
            aside.write_bytes(content)
            aside.replace(file)
        finally:
            aside.unlink(missing_ok=True)
