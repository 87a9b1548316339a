"""What an episode is, whatever it is called, wherever it lies and whenever it was written."""

import hashlib
import json
from typing import TYPE_CHECKING, Any

from sheath_manip.dataset.attributes import to_attributes
from sheath_manip.dataset.digests import digest_of
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.layout import layout

if TYPE_CHECKING:
    from sheath_manip.dataset.reader import EpisodeReader

_NOT_CONTENT = ("schema", "session", "variant", "space", "versions", "recorded_utc")
"""of the header: who wrote it and when, and what old recordings do not say"""


def content_digest(reader: "EpisodeReader", name: str) -> str:
    """Return 64 hex digits, the same for episodes of the same facts and the same arrays.

    Decompresses all of the episode, whatever its header tells; raises StoreError where it is
    damaged.
    """
    header = reader.header(name)
    digests = {spec.path: digest_of(reader.array(name, spec), spec) for spec in layout(header)}
    return hashlib.sha256(
        json.dumps([_facts(header), digests], sort_keys=True).encode()
    ).hexdigest()


def is_same(header: Header, other: Header) -> bool:
    """Return whether two episodes have the same facts and arrays, as far as both tell digests."""
    told = header.digests is not None and header.digests == other.digests
    return told and _facts(header) == _facts(other)


def _facts(header: Header) -> dict[str, Any]:
    facts = to_attributes(header)
    return {key: value for key, value in facts.items() if key not in _NOT_CONTENT}
