"""Writing Minari's data set, by Minari itself; `minari` says what is where."""

import json
import math
from collections.abc import Iterable, Iterator
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.attributes import to_attributes
from sheath_manip.dataset.exchange.actions import REQUESTED, chosen, requested
from sheath_manip.dataset.exchange.minari import ATTRIBUTE, DIGEST
from sheath_manip.dataset.exchange.replay_buffer_writing import flat
from sheath_manip.dataset.exchange.sealing import digest_of
from sheath_manip.dataset.exchange.selection import ActionChoice
from sheath_manip.dataset.exchange.uniform import uniform
from sheath_manip.dataset.extras import needs
from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.recorded import Recorded

with needs("minari", "minari"):
    import minari
    from gymnasium import spaces
    from minari.data_collector import EpisodeBuffer
    from minari.dataset.minari_storage import MinariStorage


def write(target: Path, episodes: Iterable[Recorded], action: ActionChoice) -> None:
    """Write `episodes` into the directory `target`.

    Minari finds it where `target`'s parent is its MINARI_DATASETS_PATH and `target`'s name is asked
    for, such as `driving-v0`.
    """
    alike = uniform(episodes)
    first = next(alike)
    observed = _observed(first)
    unbounded = {"low": -np.inf, "high": np.inf, "dtype": np.float32}
    # It joins a relative path to itself.
    data = target.absolute() / "data"
    data.mkdir(parents=True)
    storage = MinariStorage.new(
        data,
        observation_space=spaces.Dict(
            {
                name: spaces.Box(0, 255, values.shape[1:], np.uint8)
                if name.startswith("image_")
                else spaces.Box(shape=values.shape[1:], **unbounded)
                for name, values in observed.items()
            }
        ),
        action_space=spaces.Box(shape=(first.header.action_size,), **unbounded),
        jpeg_encoding=False,
    )
    storage.update_metadata(
        {
            "dataset_id": target.name,
            "minari_version": minari.__version__,
            "description": f"episodes of the task {first.header.info.task!r} of sheath-manip",
            "algorithm_name": first.header.info.method or "unknown",
        }
    )
    headers = []

    def buffers() -> Iterator[EpisodeBuffer]:
        for number, recorded in enumerate(chain([first], alike)):
            header = json.dumps(to_attributes(recorded.header))
            headers.append({ATTRIBUTE: header, DIGEST: digest_of(recorded)})
            yield _buffer(recorded, action, number)

    storage.update_episodes(buffers())
    storage.update_episode_metadata(headers)


def _buffer(recorded: Recorded, action: ActionChoice, number: int) -> EpisodeBuffer:
    header = recorded.header
    # Minari asks for lists in its types and takes arrays.
    arrays: Any = recorded.arrays
    last: Any = np.arange(header.length) == header.length - 1
    actions: Any = chosen(recorded, action)
    infos = {REQUESTED: requested(recorded)}
    for spec in layout(header):
        if spec.path.startswith(("images/", "features", "final/")):
            continue
        if f"final/{spec.path}" in arrays:
            infos[spec.path] = _with_final(recorded, spec.path)
        elif spec.path != "reward":
            infos[spec.path] = arrays[spec.path]
    return EpisodeBuffer(
        id=number,
        seed=header.info.seed,
        observations=_observed(recorded),
        actions=actions,
        rewards=arrays["reward"],
        terminations=last & header.terminated,
        truncations=last & header.truncated,
        # Neither HDF5's reader there nor its writer takes an array without elements.
        infos={name: values for name, values in infos.items() if values.size},
    )


def _observed(recorded: Recorded) -> dict[str, NDArray]:
    """(T+1, ...) by name."""
    return {
        flat(spec.path): _with_final(recorded, spec.path)
        for spec in layout(recorded.header)
        if spec.path.startswith(("images/", "features")) and math.prod(spec.shape)
    }


def _with_final(recorded: Recorded, path: str) -> NDArray:
    final = np.asarray(recorded.arrays[f"final/{path}"])
    return np.concatenate([recorded.arrays[path], final[None]])
