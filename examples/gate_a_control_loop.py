"""A gate around a control loop of your own: your robot, your policy, your recordings.

    python examples/gate_a_control_loop.py [gate_a_control_loop.png]

A policy steers through the gap in a wall, and knows no way back where a gust has blown it aside.
`gate fit` makes its gate from recordings alone. In the picture: faint alone, strong under the gate.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import zarr

import sheath_manip as sheath
from sheath_manip.command import main


def act(observation):  # your policy
    return np.clip([1.0, -2.0 * observation.features[1]], -1, 1)


def expert(x, y):  # a person, or whatever knows what to do
    return np.clip([-0.5 if x < 0.1 and abs(y) > 0.1 - 0.4 * x else 1.0, -2.0 * y], -1, 1)


def drive(rng, policy=None, gate=None, gust_m=0.0):  # your loop, until it is through or hits
    place, way = np.array([-1.0, rng.uniform(-0.4, 0.4)]), []
    while place[0] < 0.5 and not (abs(place[0]) < 0.02 and abs(place[1]) > 0.15):
        observation = sheath.Observation({}, np.float32(place), time_s=0.05 * len(way))
        actor, action = "expert", expert(*place)
        if policy:
            proposal = policy.propose(observation.alone)
            actor = gate.decide(observation, proposal).actor if gate else "policy"
            action = proposal.now[0] if actor == "policy" else action
        way.append((*place, *action, actor == "policy"))
        place = place + 0.03 * action + rng.normal(0, 0.004, 2) + [0, gust_m * (len(way) == 22)]
    return np.array(way)


if __name__ == "__main__":
    shown = [drive(np.random.default_rng(number)) for number in range(30)]
    rows = np.concatenate(shown).astype(np.float32)
    data = zarr.open_group("recordings.zarr", mode="w", zarr_format=2)  # as a ReplayBuffer has it
    data.create_array("data/state", data=rows[:, :2])
    data.create_array("data/action", data=rows[:, 2:4])
    data.create_array("meta/episode_ends", data=np.cumsum([len(each) for each in shown]))
    told = ["--keys", "features=state", "--task", "gap", "--control-rate-hz", "20"]
    asked = ["--gate.threshold.false-alarm-rate", "0.05", "--out", "gate.npz"]
    where = ["--policy", f"{__file__}:act", "--data", "replay-buffer:recordings.zarr"]
    assert main(["gate", "fit", *where, *told, *asked]) == 0
    policy = sheath.from_callable(act)
    axes = plt.figure(figsize=(8, 4.5)).add_subplot(aspect="equal")
    axes.plot([0, 0, np.nan, 0, 0], [-0.5, -0.15, np.nan, 0.15, 0.7], "k", lw=4)
    for gate, strength in ((None, 0.3), (sheath.load_gate("gate.npz", policy), 1)):
        x, y, *_, by_policy = drive(np.random.default_rng(99), policy, gate, gust_m=0.4).T
        axes.scatter(x, y, c=np.where(by_policy, "C0", "C1"), alpha=strength, s=14)
        print(f"{'gated' if gate else 'alone'}: {'through' if x[-1] > 0.4 else 'into the wall'}")
    plt.savefig([*sys.argv[1:], "gate_a_control_loop.png"][0])
