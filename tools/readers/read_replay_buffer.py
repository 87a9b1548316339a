"""zarr-python 2 reads an exported ReplayBuffer and compares it with what was stored, to the bit.

python read_replay_buffer.py EXPORTED EXPECTED.npz
"""

import sys

import numpy as np
import zarr

exported, expected = sys.argv[1], np.load(sys.argv[2])
root = zarr.open(exported, mode="r")
ends = root["meta/episode_ends"][:]
starts = [0, *ends[:-1]]
assert len(ends) == int(expected["episodes"]), (len(ends), int(expected["episodes"]))
compared = 0
for key in expected.files:
    if key == "episodes":
        continue
    number, name = int(key.split("/")[0]), key.split("/", 1)[1]
    flat = name.replace("images/", "image_").replace("/", "_")
    if name.startswith("final/"):
        found = root["meta"][flat][number]
    else:
        found = root["data"][flat][starts[number] : ends[number]]
    wanted = expected[key]
    found = np.asarray(found)
    assert found.dtype == wanted.dtype, (key, found.dtype, wanted.dtype)
    assert found.shape == wanted.shape, (key, found.shape, wanted.shape)
    assert found.tobytes() == wanted.tobytes(), key
    compared += 1
executed = np.concatenate([expected[f"{n}/executed"] for n in range(len(ends))])
assert np.asarray(root["data/action"][: ends[-1]]).tobytes() == executed.tobytes()
print(f"zarr {zarr.__version__}: {len(ends)} episodes, {ends[-1]} steps, {compared} arrays equal")
