"""What a block that zstd compressed tells of itself, without decompressing it."""

_ZSTD_FRAME = bytes.fromhex("28b52ffd")
"""what each compressed block begins with, RFC 8878, 3.1.1"""


def zstd_told_bytes(content: bytes) -> int | None:
    """Return the size that the first frame tells of, RFC 8878, 3.1.1.1; None where it does not."""
    if len(content) < 6 or content[:4] != _ZSTD_FRAME:
        return None
    descriptor = content[4]
    flag, single, dictionary = descriptor >> 6, descriptor >> 5 & 1, descriptor & 3
    if not flag and not single:
        return None
    start, length = 5 + (1 - single) + (0, 1, 2, 4)[dictionary], (1, 2, 4, 8)[flag]
    told = int.from_bytes(content[start : start + length], "little")
    # A size of two bytes begins to count where that of one ends.
    return told + 256 if flag == 1 else told


def zstd_checksum(content: bytes) -> bytes:
    """Return the checksum that ends a frame, RFC 8878, 3.1.1: the low half of its xxHash64.

    It is of what was compressed, and every decoder holds that against it. Raises ValueError where
    the frame has none.
    """
    if len(content) < 6 or not content[4] >> 2 & 1:
        raise ValueError("wanted a block with a checksum")
    return content[-4:]
