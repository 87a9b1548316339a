"""Minari loads an exported dataset and compares it with what was stored, to the bit.

python read_minari.py EXPORTED EXPECTED.npz
"""

import os
import sys
from pathlib import Path

import numpy as np

exported, expected = Path(sys.argv[1]), np.load(sys.argv[2])
os.environ["MINARI_DATASETS_PATH"] = str(exported.parent)

import minari  # noqa: E402 - it reads the environment

dataset = minari.load_dataset(exported.name)
episodes = int(expected["episodes"])
assert dataset.total_episodes == episodes, (dataset.total_episodes, episodes)
compared = 0
for number, episode in enumerate(dataset.iterate_episodes()):
    wanted = {k.split("/", 1)[1]: expected[k] for k in expected.files if k.startswith(f"{number}/")}
    pairs = [(episode.actions, wanted["executed"]), (episode.rewards, wanted["reward"])]
    for name, before in wanted.items():
        if name.startswith("final/") or name in ("executed", "reward") or not before.size:
            continue
        if name.startswith("images/") or name == "features":
            found = episode.observations[name.replace("images/", "image_")]
        else:
            found = episode.infos[name]
        final = wanted.get(f"final/{name}")
        whole = before if final is None else np.concatenate([before, final[None]])
        pairs.append((found, whole))
    for a, b in pairs:
        a = np.asarray(a)
        assert (a.dtype, a.shape) == (b.dtype, b.shape), (number, a.dtype, b.dtype, a.shape)
        assert a.tobytes() == b.tobytes(), number
        compared += 1
print(
    f"minari {minari.__version__}: {episodes} episodes, {dataset.total_steps} steps, "
    f"{compared} arrays equal"
)
