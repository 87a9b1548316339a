"""LeRobot's LeRobotDataset loads an exported dataset and compares it with what was stored.

python read_lerobot.py EXPORTED EXPECTED.npz
"""

import sys

import declare_torchvision  # noqa: F401
import lerobot
import numpy as np
from lerobot.datasets.lerobot_dataset import CODEBASE_VERSION, LeRobotDataset

exported, expected = sys.argv[1], np.load(sys.argv[2])
dataset = LeRobotDataset("local/exported", root=exported)
episodes = int(expected["episodes"])
assert dataset.meta.total_episodes == episodes, (dataset.meta.total_episodes, episodes)
renamed = {"features": "observation.state", "reward": "next.reward"}
frame = 0
for number in range(episodes):
    wanted = {k.split("/", 1)[1]: expected[k] for k in expected.files if k.startswith(f"{number}/")}
    wanted = {k: v for k, v in wanted.items() if not k.startswith("final/") and v.size}
    length = len(wanted["executed"])
    for t in range(length):
        item = dataset[frame]
        assert (int(item["episode_index"]), int(item["frame_index"])) == (number, t)
        assert bool(item["next.done"]) == (t == length - 1)
        assert item["action"].numpy().tobytes() == wanted["executed"][t].tobytes()
        for name, values in wanted.items():
            if name.startswith("images/"):
                found = item[name.replace("images/", "observation.images.")]
                found = np.round(found.numpy() * 255).astype(np.uint8).transpose(1, 2, 0)
                assert np.array_equal(found, values[t]), (frame, name)
            else:
                # It hands out float32 whatever was stored.
                found = item[renamed.get(name, name)].numpy()
                value = values[t].astype(found.dtype).reshape(found.shape)
                assert np.array_equal(found, value, equal_nan=found.dtype.kind == "f"), (
                    frame,
                    name,
                )
        frame += 1
assert len(dataset) == frame
print(
    f"lerobot {lerobot.__version__} (format {CODEBASE_VERSION}): {episodes} episodes, {frame} "
    "frames; actions and images equal to the bit, the rest as float32"
)
