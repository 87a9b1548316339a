"""LeRobot writes the small data set: in format 3.0 by lerobot 0.4, in format 2.1 by lerobot 0.3.

python write_small_lerobot.py OUT
"""

import sys

import declare_torchvision  # noqa: F401
import lerobot
import numpy as np
from lerobot.datasets.lerobot_dataset import CODEBASE_VERSION, LeRobotDataset
from small_set import ACTION, FPS, LENGTHS, SIZE_PX, SMALL_PX, STATE, TASKS, episode

IMAGE_AXES = ["height", "width", "channels"]
FEATURES = {
    "observation.state": {"dtype": "float32", "shape": (len(STATE),), "names": list(STATE)},
    "action": {"dtype": "float32", "shape": (len(ACTION),), "names": list(ACTION)},
    "next.reward": {"dtype": "float32", "shape": (1,), "names": None},
    "next.success": {"dtype": "bool", "shape": (1,), "names": None},
    "intervention": {"dtype": "bool", "shape": (1,), "names": None},
    "observation.images.film": {
        "dtype": "video",
        "shape": (SIZE_PX, SIZE_PX, 3),
        "names": IMAGE_AXES,
    },
    "observation.images.small": {
        "dtype": "image",
        "shape": (SMALL_PX, SMALL_PX, 3),
        "names": IMAGE_AXES,
    },
}
COLUMNS = {
    "observation.state": "state",
    "action": "action",
    "next.reward": "reward",
    "next.success": "success",
    "intervention": "intervention",
    "observation.images.film": "film",
    "observation.images.small": "small",
}

dataset = LeRobotDataset.create("local/small", FPS, FEATURES, root=sys.argv[1])
for number, task in enumerate(TASKS):
    columns = episode(number)
    for t in range(LENGTHS[number]):
        frame = {theirs: np.atleast_1d(columns[ours][t]) for theirs, ours in COLUMNS.items()}
        if CODEBASE_VERSION == "v2.1":
            dataset.add_frame(frame, task)
        else:
            dataset.add_frame({**frame, "task": task})
    dataset.save_episode()
if hasattr(dataset, "finalize"):
    dataset.finalize()
print(f"lerobot {lerobot.__version__} (format {CODEBASE_VERSION}): {len(LENGTHS)} episodes written")
