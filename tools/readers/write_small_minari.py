"""Minari writes the small data set; observations are nested dictionaries, images JPEGs.

python write_small_minari.py OUT
"""

import sys
from pathlib import Path

import minari
import numpy as np
from gymnasium import spaces
from minari.data_collector import EpisodeBuffer
from minari.dataset.minari_storage import MinariStorage
from small_set import ACTION, LENGTHS, SIZE_PX, STATE, after, episode


def write(out: Path) -> None:
    """Write it to a directory of that name, whose parent is Minari's MINARI_DATASETS_PATH."""
    unbounded = {"low": -np.inf, "high": np.inf, "dtype": np.float32}
    film = spaces.Box(0, 255, (SIZE_PX, SIZE_PX, 3), np.uint8)
    state = spaces.Box(shape=(len(STATE),), **unbounded)
    data = out.absolute() / "data"
    data.mkdir(parents=True)
    storage = MinariStorage.new(
        data,
        observation_space=spaces.Dict({"camera": film, "robot": spaces.Dict({"state": state})}),
        action_space=spaces.Box(shape=(len(ACTION),), **unbounded),
    )
    storage.update_metadata({"dataset_id": out.name, "minari_version": minari.__version__})
    storage.update_episodes(map(_buffer, range(len(LENGTHS))))


def _buffer(number: int) -> EpisodeBuffer:
    columns, last = episode(number), after(number)
    end = np.arange(LENGTHS[number]) == LENGTHS[number] - 1
    return EpisodeBuffer(
        id=number,
        seed=number,
        observations={
            "camera": np.concatenate([columns["film"], last["film"][None]]),
            "robot": {"state": np.concatenate([columns["state"], last["state"][None]])},
        },
        actions=columns["action"],
        rewards=columns["reward"],
        terminations=end & (number == 0),
        truncations=end & (number != 0),
        infos={"success": columns["success"], "name": ["x"] * LENGTHS[number]},
    )


if __name__ == "__main__":
    write(Path(sys.argv[1]))
    print(f"minari {minari.__version__}: {len(LENGTHS)} episodes written")
