"""Stand-ins for LeRobot, which is no development package: a directory of its, and a network."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import torch

from sheath_manip.adapters.lerobot import FILES
from sheath_manip.adapters.lerobot_inputs import Inputs
from sheath_manip.adapters.lerobot_policy import LeRobotPolicy
from sheath_manip.types import ActionSpec, Observations, TaskSpec

ONE = np.ones(2, np.float32)
SPEC = TaskSpec(
    name="drawn",
    control_rate_hz=10.0,
    action=ActionSpec(("left", "right"), -ONE, ONE),
    cameras={"front": (8, 6), "wrist": (4, 4)},
    feature_names=("a", "b", "c", "d", "e"),
    max_steps=30,
    metric="none",
)
VECTORS = {"observation.state": 2, "observation.environment_state": 3}
IMAGES = {"observation.images.front": (8, 6), "observation.images.wrist": (4, 4)}


def config(**changes: Any) -> dict[str, Any]:
    """Return what LeRobot writes of a policy, as far as it is looked at."""
    kinds = {"observation.state": "STATE", "observation.environment_state": "ENV"}
    inputs = {name: {"type": kinds[name], "shape": [size]} for name, size in VECTORS.items()}
    for name, (height, width) in IMAGES.items():
        inputs[name] = {"type": "VISUAL", "shape": [3, height, width]}
    action = {"action": {"type": "ACTION", "shape": [2]}}
    return {"type": "act", "input_features": inputs, "output_features": action} | changes


def write_directory(path: Path, content: Any) -> Path:
    """Write the files that there must be, of which only the config holds anything."""
    path.mkdir(parents=True)
    for name in FILES:
        (path / name).write_bytes(b"")
    (path / "config.json").write_text(json.dumps(content))
    return path


def observations(count: int, seed: int = 0) -> Observations:
    """n observations of `SPEC`."""
    rng = np.random.default_rng(seed)
    images = {
        name: rng.integers(0, 256, (count, *size, 3), np.uint8)
        for name, size in SPEC.cameras.items()
    }
    return Observations(images, rng.normal(size=(count, 5)).astype(np.float32))


class CountingChunks:
    """Plans k steps: in step i the first feature of the oldest state looked at, plus i tenths."""

    draws = True

    def __init__(self, length: int = 4, history: int = 1) -> None:
        self.length, self.history = length, history
        self.seeds: list[int] = []
        self.looks: list[list[float]] = []

    def reset(self) -> None:
        return

    def plan(self, seen, seed):
        self.seeds.append(seed)
        self.looks.append([float(each["observation.state"][0, 0]) for each in seen])
        return self.predict(seen[0])

    def predict(self, seen):
        steps = torch.arange(self.length) / 10
        first = seen["observation.state"][:, :1, None]
        return (first + steps[:, None]).repeat(1, 1, 2)


def policy_of(chunks: CountingChunks, bounded: bool = True) -> LeRobotPolicy:
    """Return the policy around it, with pipelines that double nothing but the actions."""
    return LeRobotPolicy(
        chunks,
        Inputs(VECTORS, IMAGES),
        preprocess=lambda batch: batch,
        postprocess=lambda actions: 2 * actions,
        action=SPEC.action,
        bounded=bounded,
        task="",
    )
