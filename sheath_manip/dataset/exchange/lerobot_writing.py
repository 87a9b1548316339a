"""Writing LeRobot's dataset v3, by LeRobot itself; `lerobot` says what is where."""

import json
from collections.abc import Iterable, Iterator, Mapping
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.attributes import to_attributes
from sheath_manip.dataset.exchange.actions import REQUESTED, chosen, requested
from sheath_manip.dataset.exchange.lerobot import HEADERS, feature_name
from sheath_manip.dataset.exchange.selection import ActionChoice
from sheath_manip.dataset.exchange.uniform import uniform
from sheath_manip.dataset.extras import needs
from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.exceptions import StoreError
from sheath_manip.types import Outcome

with needs("lerobot", "lerobot"):
    # Not among the development packages: it wants a torch before 2.11.
    from lerobot.datasets.lerobot_dataset import (  # pyright: ignore[reportMissingImports]
        LeRobotDataset,
    )


def write(target: Path, episodes: Iterable[Recorded], action: ActionChoice) -> None:
    """Write `episodes` into the directory `target`, in the format of LeRobot's v3.

    Raises StoreError where the control rate is no whole number, which LeRobot wants.
    """
    alike = uniform(episodes)
    first = next(alike)
    rate_hz = first.header.info.control_rate_hz
    if rate_hz != round(rate_hz):
        raise StoreError(f"LeRobot wants whole frames a second; these have {rate_hz:g}")
    dataset = LeRobotDataset.create(
        repo_id=f"local/{target.name}",
        fps=round(rate_hz),
        features={name: _feature(values[0]) for name, values in _columns(first, action).items()},
        root=target,
        use_videos=False,
    )
    headers = []
    for recorded in chain([first], alike):
        told = recorded.header.instruction or recorded.header.info.task
        for frame in _frames(_columns(recorded, action)):
            dataset.add_frame({**frame, "task": told})
        dataset.save_episode()
        headers.append(to_attributes(recorded.header))
    dataset.finalize()
    (target / HEADERS).write_text(json.dumps(headers))


def _columns(recorded: Recorded, action: ActionChoice) -> dict[str, NDArray]:
    """(T, ...) by feature; LeRobot has no scalars and no empty vectors."""
    header, arrays = recorded.header, recorded.arrays
    last = np.arange(header.length) == header.length - 1
    columns = {
        feature_name(spec.path): arrays[spec.path]
        for spec in layout(header)
        if not spec.path.startswith("final/") and spec.path != "limited"
    }
    # Its frames are all alike, but only the limits that acted in an episode have a column there.
    columns["limited"] = (
        _largest(arrays["limited"]) if header.limits else np.full(len(last), np.nan)
    )
    columns["action"] = chosen(recorded, action)
    columns[REQUESTED] = requested(recorded)
    columns["next.terminated"] = last & header.terminated
    columns["next.truncated"] = last & header.truncated
    columns["next.done"] = last
    columns["next.success"] = last & (header.outcome is Outcome.SUCCESS)
    return {
        name: values if values.ndim > 1 else values[:, None]
        for name, values in columns.items()
        if values.size
    }


def _largest(limited: NDArray) -> NDArray[np.float64]:
    """(T,) of (T, l) with NaN where a limit did not act."""
    return np.where(np.isnan(limited).all(axis=1), np.nan, np.nan_to_num(limited).max(axis=1))


def _feature(value: NDArray) -> Mapping[str, Any]:
    if value.ndim == 3:
        names = ["height", "width", "channels"]
        return {"dtype": "image", "shape": value.shape, "names": names}
    return {"dtype": value.dtype.name, "shape": value.shape, "names": None}


def _frames(columns: Mapping[str, NDArray]) -> Iterator[dict[str, NDArray]]:
    for t in range(len(columns["action"])):
        yield {name: values[t] for name, values in columns.items()}
