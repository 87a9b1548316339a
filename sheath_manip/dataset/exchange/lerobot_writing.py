"""Writing LeRobot's dataset v3, by LeRobot itself; `lerobot` says what is where."""

import json
from collections.abc import Iterable, Iterator, Mapping
from itertools import chain
from pathlib import Path

from numpy.typing import NDArray

from sheath_manip.dataset.attributes import to_attributes
from sheath_manip.dataset.exchange.lerobot import HEADERS
from sheath_manip.dataset.exchange.lerobot_columns import columns_of, features
from sheath_manip.dataset.exchange.selection import ActionChoice
from sheath_manip.dataset.exchange.uniform import uniform
from sheath_manip.dataset.extras import needs
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.exceptions import StoreError

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
        features=features(first, action),
        root=target,
        use_videos=False,
    )
    headers = []
    for recorded in chain([first], alike):
        told = recorded.header.instruction or recorded.header.info.task
        for frame in _frames(columns_of(recorded, action)):
            dataset.add_frame({**frame, "task": told})
        dataset.save_episode()
        headers.append(to_attributes(recorded.header))
    dataset.finalize()
    (target / HEADERS).write_text(json.dumps(headers))


def _frames(columns: Mapping[str, NDArray]) -> Iterator[dict[str, NDArray]]:
    for t in range(len(columns["action"])):
        yield {name: values[t] for name, values in columns.items()}
