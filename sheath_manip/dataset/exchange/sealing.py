"""A digest of each episode that is exported: a bit that changed on its way is found on import."""

import hashlib
import json
from typing import Any

import numpy as np

from sheath_manip.dataset.attributes import to_attributes
from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.exceptions import StoreError


def digest_of(recorded: Recorded) -> str:
    """Return 64 hex digits over the header and all arrays, however they are stored."""
    facts = json.dumps(to_attributes(recorded.header), sort_keys=True)
    digest = hashlib.sha256(facts.encode())
    for spec in layout(recorded.header):
        array = np.asarray(recorded.arrays[spec.path])
        digest.update(f"{spec.path} {array.dtype.name} {array.shape}\n".encode())
        digest.update(array.tobytes())
    return digest.hexdigest()


def require_digest(where: str, recorded: Recorded, told: Any) -> None:
    """Raise StoreError where an episode has a digest, and it is another one."""
    if told is not None and told != digest_of(recorded):
        raise StoreError(
            f"{where} is not what was exported: its digest belongs to other content; copy or "
            "export it again"
        )
