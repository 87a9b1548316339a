"""LeRobot's own loop and `load_policy` drive the same small policies, to the same bits.

python drive_lerobot.py DIRECTORY

makes an ACT, an ACT that averages over past chunks and a Diffusion policy of random weights, has
LeRobot save them in DIRECTORY, and compares. The one beside `write_lerobot.py` that imports this
project.
"""

import logging
import sys
from pathlib import Path

import declare_torchvision  # noqa: F401
import lerobot
import numpy as np
import torch
from lerobot.configs.types import FeatureType, PolicyFeature
from lerobot.policies.act.configuration_act import ACTConfig
from lerobot.policies.act.modeling_act import ACTPolicy
from lerobot.policies.diffusion.configuration_diffusion import DiffusionConfig
from lerobot.policies.diffusion.modeling_diffusion import DiffusionPolicy
from lerobot.policies.factory import make_pre_post_processors

from sheath_manip.adapters.lerobot import load_policy
from sheath_manip.exceptions import CheckpointError
from sheath_manip.types import ActionSpec, Observations, TaskSpec

STEPS, CHUNK = 23, 5
WIDTHS = {"observation.state": 3, "observation.environment_state": 4}
SIZE = (64, 64)
ONE = np.ones(2, np.float32)
SPEC = TaskSpec(
    name="drawn",
    control_rate_hz=10.0,
    action=ActionSpec(("left", "right"), -9 * ONE, 9 * ONE),
    cameras={"front": SIZE, "wrist": SIZE},
    feature_names=tuple("abcdefg"),
    max_steps=STEPS,
    metric="none",
)


def features(action):
    """What goes in, or the action that comes out."""
    if action:
        return {"action": PolicyFeature(FeatureType.ACTION, (2,))}
    kinds = FeatureType.STATE, FeatureType.ENV
    vectors = {
        name: PolicyFeature(kind, (width,))
        for (name, width), kind in zip(WIDTHS.items(), kinds, strict=True)
    }
    images = {
        f"observation.images.{camera}": PolicyFeature(FeatureType.VISUAL, (3, *SIZE))
        for camera in SPEC.cameras
    }
    return {**vectors, **images}


def statistics():
    """Of a data set that there is none of."""
    rng = np.random.default_rng(1)
    stats = {}
    for name, width in {**WIDTHS, "action": 2}.items():
        low = rng.normal(size=width).astype(np.float32)
        high = low + rng.uniform(0.5, 2, width).astype(np.float32)
        stats[name] = {"min": low, "max": high, "mean": (low + high) / 2, "std": (high - low) / 4}
    for camera in SPEC.cameras:
        shape = (3, 1, 1)
        stats[f"observation.images.{camera}"] = {
            "min": np.zeros(shape, np.float32),
            "max": np.ones(shape, np.float32),
            "mean": np.full(shape, 0.4, np.float32),
            "std": np.full(shape, 0.2, np.float32),
        }
    return stats


def save(policy, path):
    """Have LeRobot write policy and pipelines."""
    pipelines = make_pre_post_processors(policy.config, dataset_stats=statistics())
    policy.save_pretrained(path)
    for pipeline in pipelines:
        pipeline.save_pretrained(path)


def observations():
    """One an episode's step."""
    rng = np.random.default_rng(0)
    for _ in range(STEPS):
        images = {camera: rng.integers(0, 256, (1, *SIZE, 3), np.uint8) for camera in SPEC.cameras}
        yield Observations(images, rng.normal(size=(1, 7)).astype(np.float32))


def own_loop(policy, path, seeds):
    """(STEPS, 2) LeRobot's own actions, as its evaluation asks for them."""
    before, after = make_pre_post_processors(policy.config, pretrained_path=str(path))
    policy.reset()
    actions = []
    for seen in observations():
        batch = {
            name: torch.from_numpy(rows)
            for name, rows in zip(WIDTHS, np.split(seen.features, [3], axis=1), strict=True)
        }
        for camera, images in seen.images.items():
            pixels = torch.from_numpy(images).type(torch.float32) / 255
            batch[f"observation.images.{camera}"] = pixels.permute(0, 3, 1, 2).contiguous()
        if len(actions) % CHUNK == 0:
            torch.manual_seed(int(seeds.integers(2**63)))
        with torch.inference_mode():
            actions.append(after(policy.select_action(before({**batch, "task": [""]})))[0].numpy())
    return np.stack(actions)


def compare(kind, policy, network, path):
    """Both loops on the same observations."""
    save(policy, path)
    wanted = own_loop(policy, path, np.random.default_rng(7))
    ours = load_policy(path, spec=SPEC)
    passes = []
    hook = network(ours.chunks.policy).register_forward_hook(lambda *_: passes.append(1))
    ours.reset(np.random.default_rng(7))
    proposals = [ours.propose(seen) for seen in observations()]
    hook.remove()
    found = np.stack([proposal.now[0] for proposal in proposals])
    assert np.array_equal(found, wanted), (kind, np.abs(found - wanted).max())
    chunk = ours.chunks.policy.config.n_action_steps
    assert [each.actions.shape[1] for each in proposals] == [
        chunk - step % chunk for step in range(STEPS)
    ]
    # What somebody else has made void is planned anew.
    ours.reset(np.random.default_rng(7))
    ours.propose(next(observations()))
    ours.replan()
    assert ours.propose(next(observations())).actions.shape == (1, chunk, 2)
    # A look at many states keeps and draws nothing.
    seen = list(observations())
    many = Observations(
        {name: np.concatenate([each.images[name] for each in seen]) for name in SPEC.cameras},
        np.concatenate([each.features for each in seen]),
    )
    predicted = ours.predict(many)
    assert predicted.actions.shape == (STEPS, chunk, 2)
    assert np.array_equal(predicted.actions, ours.predict(many).actions)
    losses = ours.surrogate_losses(predicted, predicted.now)
    assert losses.shape == (STEPS,)
    assert not losses.any()
    return f"{kind}: {len(passes)} passes"


def refuses(path, says, **where):
    """A line for what LeRobot cannot load."""
    try:
        load_policy(path, **where)
    except CheckpointError as error:
        line = str(error)
    assert says in line, line
    assert "\n" not in line


logging.disable(logging.WARNING)
torch.set_num_threads(1)
torch.manual_seed(0)
directory = Path(sys.argv[1])
common = {
    "device": "cpu",
    "push_to_hub": False,
    "input_features": features(action=False),
    "output_features": features(action=True),
}
small = {
    **common,
    "dim_model": 32,
    "n_heads": 2,
    "dim_feedforward": 32,
    "n_encoder_layers": 1,
    "n_vae_encoder_layers": 1,
    "pretrained_backbone_weights": None,
}
act = ACTPolicy(ACTConfig(chunk_size=8, n_action_steps=CHUNK, **small))
averaging = ACTConfig(chunk_size=8, n_action_steps=1, temporal_ensemble_coeff=0.01, **small)
diffusion = DiffusionConfig(
    horizon=8,
    n_action_steps=CHUNK,
    down_dims=(16, 32),
    n_groups=4,
    num_train_timesteps=4,
    spatial_softmax_num_keypoints=4,
    **common,
)
said = [
    compare("act", act, lambda policy: policy.model, directory / "act"),
    compare(
        "act averaging", ACTPolicy(averaging), lambda policy: policy.model, directory / "averaging"
    ),
    compare(
        "diffusion",
        DiffusionPolicy(diffusion),
        lambda policy: policy.diffusion.rgb_encoder,
        directory / "diffusion",
    ),
]
# Without the task's spec it goes by the actions that the policy was trained on.
loose = load_policy(directory / "act")
assert np.allclose(loose.action.minimum, statistics()["action"]["min"])
assert np.allclose(loose.action.maximum, statistics()["action"]["max"])
refuses(directory / "act", "on nowhere", device="nowhere")
weights = directory / "act" / "model.safetensors"
weights.write_bytes(weights.read_bytes()[:1000])
refuses(directory / "act", "LeRobot cannot load")
print(f"lerobot {lerobot.__version__}: {STEPS} steps equal to the bit; {', '.join(said)}")
