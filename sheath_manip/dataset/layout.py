"""Which arrays make up an episode of T steps.

| array | shape, type | meaning |
|---|---|---|
| `images/CAMERA` | (T, h, w, 3) uint8 | RGB before the action |
| `features` | (T, f) float32 | before the action |
| `time_s` | (T,) float64 | before the action |
| `state` | (T, s) float64 | simulator state before the action |
| `proposed` | (T, a) float32 | by the policy; NaN where `has_proposed` is false |
| `labelled` | (T, a) float32 | by who acts as the expert; NaN where `has_labelled` is false |
| `executed` | (T, a) float32 | what was commanded, after the command filter where there is one |
| `actor`, `reason` | (T,) uint8 | place in the attributes `actors`, `reasons` |
| `intervention` | (T,) bool | somebody else than the policy acts, though there was one |
| `query` | (T,) bool | the gate asked for a label; only there `labelled` is one to learn from |
| `score`, `threshold` | (T,) float64 | of the support; NaN where the gate has none |
| `reward` | (T,) float64 | of the executed action |
| `limited` | (T, l) float64 | by how much each limit changed the command; NaN where it did not |
| `signals` | (T, k, 2) float64 | each signal's score, and its share among held-out expert steps |
| `final/...` | no T | `images/CAMERA`, `features`, `time_s`, `state` after the last action |


The columns of `limited` are the attribute `limits`; where no limit acted in the whole episode there
is neither. Those of `signals` are the attribute of that name, and NaN where a signal has no score;
where no gate judged by any there is neither.

Holding the robot in place of the expert counts as acting without a query: it gives no label.

A policy was to drive an episode if it proposed an action in any step, or if the episode names the
checkpoint that drove it; a plain demonstration therefore has no intervention.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.header import Header

Arrays = Mapping[str, NDArray]
"""by the path of their `ArraySpec`"""
LIMITED, SIGNALS = "limited", "signals"
"""arrays whose columns each episode names itself: another one may have others, or none"""
FRAMES_PER_CHUNK = 64
"""Chunks of single frames take ten times as long to write and compress far worse."""
MOST_CHUNK_BYTES = 512 << 20
"""in memory: 64 frames of 2.7 million pixels; reading an episode takes that much at a time"""
MOST_COLUMN_BYTES = 512 << 20
"""in memory, of all arrays together that are no images: half a million steps of a kilobyte"""


@dataclass(frozen=True)
class ArraySpec:
    """One array of an episode's group."""

    path: str
    shape: tuple[int, ...]
    dtype: str
    digest: str = field(default="", compare=False)
    """of its content, see `digests`; empty where the recording does not say"""
    checksum: str = field(default="", compare=False)
    """of the checksums of its blocks; empty where the recording does not say"""

    @cached_property
    def bytes(self) -> int:
        """The size in memory."""
        return math.prod(self.shape) * np.dtype(self.dtype).itemsize

    @cached_property
    def chunks(self) -> tuple[int, ...]:
        """Images lie in blocks of frames; every other array is small and one chunk."""
        # zarr refuses a chunk of length 0, which an array without features would ask for.
        whole = tuple(max(1, size) for size in self.shape)
        if self.is_film:
            return (min(FRAMES_PER_CHUNK, whole[0]), *whole[1:])
        return whole

    @property
    def is_film(self) -> bool:
        """Whether the array holds the images of all steps: nearly all of an episode."""
        return self.is_image and len(self.shape) == 4

    @property
    def is_image(self) -> bool:
        """Whether the array holds camera images."""
        return "images/" in self.path


def layout(header: Header) -> list[ArraySpec]:
    """Every array that an episode with `header` has."""
    observation = [
        *(
            (f"images/{camera}", (height, width, 3), "uint8")
            for camera, (height, width) in header.cameras.items()
        ),
        ("features", (header.feature_size,), "float32"),
        ("time_s", (), "float64"),
        ("state", (header.state_size,), "float64"),
    ]
    limited = [(LIMITED, (len(header.limits),), "float64")] if header.limits else []
    signals = [(SIGNALS, (len(header.signals), 2), "float64")] if header.signals else []
    step = [
        *observation,
        *(
            (name, (header.action_size,), "float32")
            for name in ("proposed", "labelled", "executed")
        ),
        *((name, (), "bool") for name in ("has_proposed", "has_labelled", "intervention", "query")),
        *((name, (), "uint8") for name in ("actor", "reason")),
        *((name, (), "float64") for name in ("score", "threshold", "reward")),
        *limited,
        *signals,
    ]
    arrays: list[tuple[str, tuple[int, ...], str]] = [
        *((name, (header.length, *shape), dtype) for name, shape, dtype in step),
        *((f"final/{name}", shape, dtype) for name, shape, dtype in observation),
    ]
    digests, checksums = header.digests or {}, header.checksums or {}
    return [
        ArraySpec(*array, digests.get(array[0], ""), checksums.get(array[0], ""))
        for array in arrays
    ]


def require_bounds(header: Header) -> None:
    """Raise ValueError where an episode of such sizes would take more memory than may be."""
    specs = layout(header)
    for spec in specs:
        chunk = ArraySpec(spec.path, spec.chunks, spec.dtype)
        if chunk.bytes > MOST_CHUNK_BYTES:
            raise ValueError(
                f"{spec.path} has blocks of {chunk.bytes >> 20} MB, wanted at most "
                f"{MOST_CHUNK_BYTES >> 20}"
            )
    columns = sum(spec.bytes for spec in specs if not spec.is_image)
    if columns > MOST_COLUMN_BYTES:
        raise ValueError(
            f"its arrays but for images take {columns >> 20} MB, wanted at most "
            f"{MOST_COLUMN_BYTES >> 20}"
        )


def has_label(arrays: Arrays) -> NDArray[np.bool_]:
    """(T,) which steps have a label to learn from."""
    return arrays["has_labelled"] & arrays["query"]
