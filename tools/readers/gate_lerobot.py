"""The function of docs/own/lerobot.md gates and records an ACT that LeRobot has saved.

python gate_lerobot.py DIRECTORY

The task is that of examples/own_task.py; the weights are random, so that the gate has to do.
"""

import logging
import os
import re
import runpy
import sys
from pathlib import Path

import declare_torchvision  # noqa: F401
import numpy as np
import torch
from lerobot.configs.types import FeatureType, NormalizationMode, PolicyFeature
from lerobot.policies.act.configuration_act import ACTConfig
from lerobot.policies.act.modeling_act import ACTPolicy
from lerobot.policies.factory import make_pre_post_processors

from sheath_manip import EpisodeStore

ROOT = Path(__file__).parents[2]
STATE, ENVIRONMENT = "observation.state", "observation.environment_state"

logging.disable(logging.WARNING)
torch.set_num_threads(1)
torch.manual_seed(0)
directory = Path(sys.argv[1])
policy = ACTPolicy(
    ACTConfig(
        device="cpu",
        push_to_hub=False,
        input_features={
            STATE: PolicyFeature(FeatureType.STATE, (1,)),
            ENVIRONMENT: PolicyFeature(FeatureType.ENV, (1,)),
        },
        output_features={"action": PolicyFeature(FeatureType.ACTION, (1,))},
        normalization_mapping=dict.fromkeys(("STATE", "ENV", "ACTION"), NormalizationMode.MIN_MAX),
        chunk_size=4,
        n_action_steps=4,
        dim_model=16,
        n_heads=2,
        dim_feedforward=16,
        n_encoder_layers=1,
        n_vae_encoder_layers=1,
        pretrained_backbone_weights=None,
    )
)
one = np.ones(1, np.float32)
stats = {name: {"min": -2 * one, "max": 2 * one} for name in (STATE, ENVIRONMENT, "action")}
policy.save_pretrained(directory)
for pipeline in make_pre_post_processors(policy.config, dataset_stats=stats):
    pipeline.save_pretrained(directory)

page = (ROOT / "docs" / "own" / "lerobot.md").read_text()
names = {}
exec(re.findall(r"```python\n(.*?)```", page, re.DOTALL)[0], names)
task = runpy.run_path(str(ROOT / "examples" / "own_task.py"))["CART"]
path = directory.resolve()
os.chdir(directory)
episode = names["gated"](task, path)
columns = episode.columns
store = EpisodeStore("runs/lerobot")
assert len(store.read(store.names()[0])) == len(episode)
acted = columns.by_policy
assert np.array_equal(columns.executed[acted], columns.proposed[acted])
assert columns.has_proposed.all()
assert np.isfinite(columns.score).all()
print(f"docs/own/lerobot.md: {episode.outcome}, the expert acted in {sum(~acted)} of {len(acted)}")
