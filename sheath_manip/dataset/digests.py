"""One digest that binds an episode's header and all its arrays together.

The header tells a digest of each array, of its name, type, shape and content; and one of all that
it tells, those included. So a reader of an episode holds its header against that one digest, and
each array, once it is decoded, against the header: nothing has to be read for the digest's sake,
and a value that changed, or an array of another episode, is found. Compression is left out of it.

To hash all pixels takes as long as to read them. So the header also tells a digest of the checksums
that zstd keeps with each block, which decoding holds the block against in any case: that one is
asked for by every reader, and that of the values by `check` and by all that copies.
"""

import hashlib
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from sheath_manip.dataset.layout import ArraySpec
from sheath_manip.dataset.zstd_frame import zstd_checksum

ARRAYS, CHECKSUMS, DIGEST = "array_digests", "checksum_digests", "digest"
"""in the attributes of an episode's group"""
_DIGEST = re.compile(r"[0-9a-f]{64}")


class ArrayDigest:
    """The digest of an array whose rows come one block after the other."""

    def __init__(self, spec: ArraySpec) -> None:
        """Begin with the array's name, type and shape."""
        self._hash = _begun(spec)

    def update(self, block: NDArray) -> None:
        """Take the next rows, in C order."""
        # As bytes, since a memory view of an array without elements is none.
        self._hash.update(block.data if block.size and block.ndim else block.tobytes())

    def hexdigest(self) -> str:
        """Return 64 hex digits."""
        return self._hash.hexdigest()


class ChecksumDigest:
    """The digest of the checksums of an array's blocks."""

    def __init__(self, spec: ArraySpec) -> None:
        """Begin with the array's name, type and shape."""
        self._hash = _begun(spec)

    def update(self, block: bytes) -> None:
        """Take the next block, compressed; raises ValueError where it has no checksum."""
        self._hash.update(zstd_checksum(block))

    def hexdigest(self) -> str:
        """Return 64 hex digits."""
        return self._hash.hexdigest()


@dataclass(frozen=True)
class Seals:
    """The digests of an episode's arrays, by their paths."""

    digests: Mapping[str, str]
    """of their values"""
    checksums: Mapping[str, str] | None
    """of their blocks' checksums; None where a recording of before does not say"""


def digest_of(array: NDArray, spec: ArraySpec) -> str:
    """Return the digest of an array that is there whole; it lies in C order."""
    digest = ArrayDigest(spec)
    digest.update(array)
    return digest.hexdigest()


def sealed(attributes: Mapping[str, Any], seals: Seals) -> dict[str, Any]:
    """Return the attributes of a header with the digests of its arrays, and that of the whole."""
    checksums = {} if seals.checksums is None else {CHECKSUMS: dict(seals.checksums)}
    return stamped({**attributes, ARRAYS: dict(seals.digests), **checksums})


def unsealed(attributes: Mapping[str, Any]) -> tuple[dict[str, Any], Seals | None]:
    """Return the inverse of `sealed`; without digests, None, where the attributes tell none.

    Raises ValueError where they tell of digests that are none, or not of these attributes.
    """
    if not {ARRAYS, CHECKSUMS, DIGEST} & attributes.keys():
        return dict(attributes), None
    told = unstamped(attributes)
    digests, checksums = told.pop(ARRAYS, None), told.pop(CHECKSUMS, {})
    for each, what in ((digests, ARRAYS), (checksums, CHECKSUMS)):
        if not isinstance(each, Mapping) or not all(map(_is_digest, each.values())):
            raise ValueError(f"wanted digests of 64 hex digits as {what}")
    if checksums and checksums.keys() != digests.keys():
        raise ValueError(f"{CHECKSUMS} are of other arrays than {ARRAYS}")
    return told, Seals(dict(digests), dict(checksums) or None)


def stamped(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Return fields of JSON with the digest of them all."""
    return {**fields, DIGEST: _digest(fields)}


def unstamped(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Return the inverse of `stamped`; raises ValueError where the digest is not of the others."""
    rest = {name: value for name, value in fields.items() if name != DIGEST}
    if fields.get(DIGEST) != _digest(rest):
        raise ValueError("its digest is another: something in it has changed since it was written")
    return rest


def _digest(fields: Mapping[str, Any]) -> str:
    text = json.dumps(fields, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def _begun(spec: ArraySpec) -> Any:
    return hashlib.sha256(f"{spec.path} {spec.dtype} {spec.shape}\n".encode())


def _is_digest(value: Any) -> bool:
    return isinstance(value, str) and _DIGEST.fullmatch(value) is not None
