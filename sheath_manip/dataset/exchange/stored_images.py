"""Images that were stored encoded, PNG or JPEG, as arrays."""

import io
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from sheath_manip.dataset.exchange.limits import Limits
from sheath_manip.exceptions import StoreError

FORMATS = ("PNG", "JPEG")


def decoded(what: str, encoded: Sequence[bytes], limits: Limits) -> NDArray[np.uint8]:
    """(T, h, w, 3) RGB of T images; raises StoreError where they are of several sizes or broken."""
    if not encoded:
        return np.zeros((0, 0, 0, 3), np.uint8)
    width, height = _opened(what, encoded[0]).size
    limits.require_memory(what, len(encoded) * height * width * 3)
    images = np.empty((len(encoded), height, width, 3), np.uint8)
    for image, content in zip(images, encoded, strict=True):
        limits.require_time()
        opened = _opened(what, content)
        # Before anything is decoded.
        if opened.size != (width, height):
            raise StoreError(f"{what} has images of {opened.size} and {(width, height)} pixels")
        try:
            image[:] = np.asarray(opened.convert("RGB"))
        except (OSError, SyntaxError, ValueError) as error:
            raise StoreError(f"an image of {what} does not decode ({error})") from error
    return images


def _opened(what: str, content: bytes) -> Image.Image:
    try:
        return Image.open(io.BytesIO(content), formats=FORMATS)
    except (OSError, Image.DecompressionBombError) as error:
        wanted = " or ".join(FORMATS)
        raise StoreError(f"an image of {what} is no {wanted}, or its head is broken") from error


def is_jpeg(content: bytes) -> bool:
    """Whether bytes begin as a JPEG does."""
    return content.startswith(b"\xff\xd8\xff")
