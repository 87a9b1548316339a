"""Headers changed in the file: as recordings of before had them, or with digests that fit."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from sheath_manip.dataset.digests import ARRAYS, CHECKSUMS, DIGEST, Seals, sealed


def unseal(episode: Path, change: Callable[[dict[str, Any]], object] = lambda _: None) -> None:
    """Take the digests out of a header, as those of before had none, and change the rest."""
    group = json.loads((episode / "zarr.json").read_text())
    for key in (ARRAYS, CHECKSUMS, DIGEST):
        group["attributes"].pop(key, None)
    change(group["attributes"])
    (episode / "zarr.json").write_text(json.dumps(group))


def reseal(episode: Path, change: Callable[[dict[str, Any]], object]) -> None:
    """Change a header, and give it the digest that fits: as one who knows how would."""
    group = json.loads((episode / "zarr.json").read_text())
    digests = group["attributes"].pop(ARRAYS), group["attributes"].pop(CHECKSUMS)
    del group["attributes"][DIGEST]
    change(group["attributes"])
    group["attributes"] = sealed(group["attributes"], Seals(*digests))
    (episode / "zarr.json").write_text(json.dumps(group))
