"""Loads a policy that LeRobot has trained, so that it drives under a gate.

Wants `pip install 'sheath-manip[lerobot]'`, and no network: everything is in the directory.
"""

import io
from collections.abc import Mapping, Sequence
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np

from sheath_manip.adapters.lerobot_chunks import CHUNKS
from sheath_manip.adapters.lerobot_inputs import Inputs
from sheath_manip.adapters.lerobot_policy import LeRobotPolicy
from sheath_manip.dataset.extras import needs
from sheath_manip.exceptions import CheckpointError, UnknownNameError
from sheath_manip.files.bounded_json import parse_json
from sheath_manip.types import ActionSpec, TaskSpec

CONFIG = "config.json"
FILES = (CONFIG, "model.safetensors", "policy_preprocessor.json", "policy_postprocessor.json")
NOTHING: Mapping[str, Any] = {}


def load_policy(
    directory: str | Path,
    *,
    spec: TaskSpec | None = None,
    cameras: Mapping[str, str] = NOTHING,
    features: Mapping[str, Sequence[str]] = NOTHING,
    task: str = "",
    device: str = "cpu",
) -> LeRobotPolicy:
    """Return the ACT or Diffusion policy in a directory that LeRobot 0.4 wrote.

    It drives as under LeRobot's own loop, with the pre- and postprocessing that lie beside it.

    Args:
        directory: with config.json, model.safetensors, policy_preprocessor.json and
            policy_postprocessor.json, such as checkpoints/last/pretrained_model of a training.
        spec: of the task. With one its actions are kept within the bounds, and what the policy
            takes is held against what the task shows. None: checked at the first look, the losses
            are told by the range of the actions that it was trained on, and actions are left as
            they are.
        cameras: camera by LeRobot's name of the image, where observation.images.NAME is not that
            of the camera NAME.
        features: names of features by LeRobot's name of the vector. By default a single vector, or
            each of several as wide, is all features; else they follow each other in that order.
        task: what is to be done, in words, for a policy that takes them.
        device: where the network computes. The CPU is the reference: other devices round otherwise.

    Raises:
        CheckpointError: no such directory, or not one of a policy that LeRobot can load.
        UnknownNameError: of another kind than ACT and Diffusion.
        ParameterError: the task does not show what the policy takes.
        SetupError: LeRobot is not installed.
    """
    path = Path(directory)
    config = _config(path)
    kind = str(config.get("type"))
    if kind not in CHUNKS:
        raise UnknownNameError("kind of LeRobot policy", kind, CHUNKS)
    names = None if spec is None else spec.feature_names
    inputs = Inputs.described(config, cameras=cameras, features=features, feature_names=names)
    if spec is not None:
        inputs.check(spec)
        _check_actions(config, spec)
    policy, preprocess, postprocess = _loaded(path, kind, device)
    return LeRobotPolicy(
        CHUNKS[kind](policy),
        inputs,
        preprocess,
        postprocess,
        action=_trained_range(postprocess) if spec is None else spec.action,
        bounded=spec is not None,
        task=task,
    )


def _config(path: Path) -> Mapping[str, Any]:
    missing = [name for name in FILES if not (path / name).is_file()]
    if missing:
        inside = next((each.parent for each in sorted(path.rglob(CONFIG))), None)
        instead = (
            f"its policy is in {inside}"
            if inside is not None and inside != path
            else "wanted a policy's directory of LeRobot 0.4; of an older one LeRobot's "
            "migrate_policy_normalization makes one"
        )
        raise CheckpointError(f"{path} has no {', '.join(missing)}; {instead}")
    try:
        config = parse_json((path / CONFIG).read_bytes())
    except (OSError, ValueError) as error:
        raise CheckpointError(f"{path / CONFIG} cannot be read: {error}") from error
    if not isinstance(config, dict):
        raise CheckpointError(f"{path / CONFIG} holds no object; wanted a policy's config")
    return config


def _check_actions(config: Mapping[str, Any], spec: TaskSpec) -> None:
    try:
        (size,) = config["output_features"]["action"]["shape"]
    except (KeyError, TypeError, ValueError) as error:
        raise CheckpointError(
            "the policy's config.json names no shape of an action; wanted `output_features` as "
            "LeRobot 0.4 writes them"
        ) from error
    if size != len(spec.action.names):
        raise CheckpointError(
            f"the policy's actions have {size} numbers; wanted the {len(spec.action.names)} of "
            f"the task {spec.name!r} ({', '.join(spec.action.names)})"
        )


def _loaded(path: Path, kind: str, device: str) -> tuple[Any, Any, Any]:
    """The policy and its two pipelines."""
    with needs("lerobot", "lerobot"):
        from lerobot.configs.policies import (  # pyright: ignore[reportMissingImports]
            PreTrainedConfig,
        )
        from lerobot.policies.factory import (  # pyright: ignore[reportMissingImports]
            get_policy_class,
            make_pre_post_processors,
        )
    try:
        with redirect_stdout(io.StringIO()):
            config = PreTrainedConfig.from_pretrained(path)
            config.device = device
            # All weights are in the file: those of before the training would be downloaded in vain.
            config.pretrained_backbone_weights = None
            policy = get_policy_class(kind).from_pretrained(path, config=config, strict=True)
            on_device = {"device_processor": {"device": device}}
            pipelines = make_pre_post_processors(
                config, pretrained_path=str(path), preprocessor_overrides=on_device
            )
    except Exception as error:
        # Foreign code on foreign files: it raises anything.
        said = " ".join(str(error).split())
        raise CheckpointError(
            f"LeRobot cannot load {path} on {device} ({type(error).__name__}: {said[:300]})"
        ) from error
    return policy.eval(), *pipelines


def _trained_range(postprocess: Any) -> ActionSpec:
    """The range of the actions that the policy was trained on, which its pipeline remembers."""
    for step in postprocess.steps:
        known = (getattr(step, "stats", None) or {}).get("action", {})
        if "min" in known and "max" in known:
            low, high = (np.asarray(known[name], np.float32).ravel() for name in ("min", "max"))
            return ActionSpec(tuple(f"action {n}" for n in range(len(low))), low, high)
    raise CheckpointError(
        "the policy's postprocessor does not say in which range its actions were; wanted the "
        "task's spec"
    )
