"""The compressions that arrays of zarr may name here, each decoded to exactly what is wanted.

The list is written out: numcodecs' own holds codecs that run what a file says (`pickle`, and until
0.16.4 whatever takes objects). None of these takes more memory than the block has bytes, but for
images: they are decoded by imagecodecs, in the process apart.
"""

import bz2
import lzma
import zlib
from collections.abc import Callable, Mapping

import numpy as np
from numcodecs.blosc import Blosc
from numcodecs.zstd import Zstd

from sheath_manip.dataset.extras import needs
from sheath_manip.dataset.zstd_frame import zstd_told_bytes

Decode = Callable[[bytes, int], bytes]
"""from the content and the number of bytes that are wanted; raises ValueError for any other"""

_LZMA_BYTES = 256 << 20
"""of memory for its dictionary"""


def decoder(name: str | None) -> Decode:
    """Return what decodes blocks of a compressor; raises ValueError for one that is not listed."""
    if name not in CODECS:
        listed = ", ".join(str(known) for known in CODECS if known)
        raise ValueError(f"compressed by {name!r:.60}; wanted none, or one of {listed}")
    return CODECS[name]


def _stored(content: bytes, size: int) -> bytes:
    return _exactly(content, size)


def _zlib(content: bytes, size: int) -> bytes:
    # Either of zlib's two wrappings.
    unpacked = zlib.decompressobj(zlib.MAX_WBITS | 32)
    return _whole(unpacked.decompress(content, size + 1), size, unpacked.eof)


def _bz2(content: bytes, size: int) -> bytes:
    unpacked = bz2.BZ2Decompressor()
    return _whole(unpacked.decompress(content, size + 1), size, unpacked.eof)


def _lzma(content: bytes, size: int) -> bytes:
    unpacked = lzma.LZMADecompressor(memlimit=_LZMA_BYTES)
    return _whole(unpacked.decompress(content, size + 1), size, unpacked.eof)


def _blosc(content: bytes, size: int) -> bytes:
    told, length = (int.from_bytes(content[at : at + 4], "little") for at in (4, 12))
    if len(content) < 16 or told != size or length != len(content):
        raise ValueError(f"a block of {len(content)} bytes tells of {told}; wanted {size}")
    out = np.empty(size, np.uint8)
    Blosc().decode(content, out=out)
    return out.tobytes()


def _zstd(content: bytes, size: int) -> bytes:
    if zstd_told_bytes(content) != size:
        raise ValueError(f"a block of {len(content)} bytes tells not of {size} unpacked")
    out = np.empty(size, np.uint8)
    Zstd().decode(content, out=out)
    return out.tobytes()


def _jpegxl(content: bytes, size: int) -> bytes:
    return _image("jpegxl_decode", content, size)


def _jpeg2k(content: bytes, size: int) -> bytes:
    return _image("jpeg2k_decode", content, size)


def _image(decode: str, content: bytes, size: int) -> bytes:
    # Only now: what is no image is read without the package.
    with needs("umi", "imagecodecs"):
        import imagecodecs  # pyright: ignore[reportMissingImports]
    return _exactly(np.asarray(getattr(imagecodecs, decode)(content)).tobytes(), size)


def _whole(unpacked: bytes, size: int, ended: bool) -> bytes:
    if not ended:
        raise ValueError(f"a block goes on after {size} bytes, or is cut short")
    return _exactly(unpacked, size)


def _exactly(content: bytes, size: int) -> bytes:
    if len(content) != size:
        raise ValueError(f"a block has {len(content)} bytes; wanted {size}")
    return content


CODECS: Mapping[str | None, Decode] = {
    None: _stored,
    "blosc": _blosc,
    "bz2": _bz2,
    "gzip": _zlib,
    "imagecodecs_jpeg2k": _jpeg2k,
    "imagecodecs_jpegxl": _jpegxl,
    "lzma": _lzma,
    "zlib": _zlib,
    "zstd": _zstd,
}
