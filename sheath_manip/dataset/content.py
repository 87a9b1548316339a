"""What an episode is, whatever it is called, wherever it lies and whenever it was written."""

import hashlib
import json

import numpy as np

from sheath_manip.dataset.attributes import to_attributes
from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.reader import EpisodeReader

_NOT_CONTENT = ("schema", "session", "variant", "space", "versions", "recorded_utc")
"""of the header: who wrote it and when, and what old recordings do not say"""


def content_digest(reader: EpisodeReader, name: str) -> str:
    """Return 64 hex digits, the same for episodes of the same facts and the same arrays.

    Decompresses all of the episode; raises StoreError where it is damaged.
    """
    header = reader.header(name)
    facts = to_attributes(header)
    for key in _NOT_CONTENT:
        del facts[key]
    digest = hashlib.sha256(json.dumps(facts, sort_keys=True).encode())
    for spec in layout(header):
        digest.update(f"{spec.path} {spec.dtype} {spec.shape}\n".encode())
        digest.update(np.ascontiguousarray(reader.array(name, spec)).tobytes())
    return digest.hexdigest()
