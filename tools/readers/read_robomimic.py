"""robomimic's SequenceDataset reads an exported HDF5 file and compares it with what was stored.

python read_robomimic.py EXPORTED EXPECTED.npz
"""

import sys

import numpy as np
import robomimic
import robomimic.utils.obs_utils as obs_utils
from robomimic.utils.dataset import SequenceDataset

exported, expected = sys.argv[1], np.load(sys.argv[2])
cameras = [key.split("/")[-1] for key in expected.files if key.startswith("0/images/")]
images = [f"{camera}_image" for camera in cameras]
obs_utils.initialize_obs_utils_with_obs_specs({"obs": {"low_dim": ["features"], "rgb": images}})
dataset = SequenceDataset(
    exported,
    obs_keys=("features", *images),
    dataset_keys=(
        "actions",
        "rewards",
        "dones",
        "terminated",
        "truncated",
        "intervention",
        "requested",
    ),
    seq_length=1,
    hdf5_cache_mode=None,
)
episodes = int(expected["episodes"])
assert dataset.n_demos == episodes, (dataset.n_demos, episodes)
steps = 0
for number in range(episodes):
    found = dataset.get_trajectory_at_index(number)
    wanted = {k.split("/", 1)[1]: expected[k] for k in expected.files if k.startswith(f"{number}/")}
    steps += len(wanted["executed"])
    pairs = [
        (found["actions"], wanted["executed"]),
        (found["rewards"], wanted["reward"]),
        (found["intervention"], wanted["intervention"]),
        (found["requested"], wanted["requested"]),
        (found["obs"]["features"], wanted["features"]),
        (found["next_obs"]["features"][:-1], wanted["features"][1:]),
        (found["next_obs"]["features"][-1], wanted["final/features"]),
    ]
    for camera, image in zip(cameras, images):  # noqa: B905 - as old as robomimic's Python
        pairs.append((found["obs"][image], wanted[f"images/{camera}"]))
        pairs.append((found["next_obs"][image][-1], wanted[f"final/images/{camera}"]))
    for index, (a, b) in enumerate(pairs):
        assert a.shape == b.shape, (number, index, a.shape, b.shape)
        assert np.asarray(a, b.dtype).tobytes() == b.tobytes(), (number, index)
    assert found["dones"].tolist() == [0] * (len(wanted["executed"]) - 1) + [1]
assert len(dataset) == steps
with dataset.hdf5_file_opened() as file:
    successes = len(file["mask/success"])
print(
    f"robomimic {robomimic.__version__}: {episodes} demonstrations, {steps} sequences; actions, "
    f"rewards, interventions, observations and next ones equal; {successes} in mask/success"
)
