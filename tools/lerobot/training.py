"""LeRobot trains its ACT: its own training script, on a set of its own format."""

import shutil
from pathlib import Path
from typing import Any
from unittest.mock import patch

CHUNK = 10
POLICY = Path("checkpoints", "last", "pretrained_model")
"""where LeRobot's training leaves the policy's directory"""
BATCH = 64


class Held:
    """A LeRobot set whose items are read once, by LeRobot, and kept: reading takes three quarters.

    All else is asked of the set itself.
    """

    def __init__(self, dataset: Any) -> None:
        self._dataset = dataset
        self._items: dict[int, Any] = {}

    def __len__(self) -> int:
        return len(self._dataset)

    def __getitem__(self, index: int) -> Any:
        if index not in self._items:
            self._items[index] = self._dataset[index]
        return self._items[index]

    def __getattr__(self, name: str) -> Any:
        return getattr(self._dataset, name)


def train_act(data: Path, out: Path, *, steps: int, seed: int) -> Path:
    """Return the directory of an ACT that LeRobot has trained on the set at `data`.

    What an interrupted training left at `out` is thrown away.
    """
    # None of these is among the development packages.
    from lerobot.configs.default import (  # pyright: ignore[reportMissingImports]
        DatasetConfig,
        WandBConfig,
    )
    from lerobot.configs.train import (  # pyright: ignore[reportMissingImports]
        TrainPipelineConfig,
    )
    from lerobot.scripts import lerobot_train  # pyright: ignore[reportMissingImports]

    shutil.rmtree(out, ignore_errors=True)
    config = TrainPipelineConfig(
        dataset=DatasetConfig(repo_id=f"local/{data.name}", root=str(data)),
        policy=act_config(),
        output_dir=out,
        job_name=out.name,
        seed=seed,
        num_workers=0,
        batch_size=BATCH,
        steps=steps,
        eval_freq=0,
        log_freq=500,
        save_freq=steps,
        wandb=WandBConfig(enable=False),
    )
    make = lerobot_train.make_dataset
    with patch.object(lerobot_train, "make_dataset", lambda config: Held(make(config))):
        lerobot_train.train(config)
    return out / POLICY


def act_config() -> Any:
    """Return LeRobot's configuration of an ACT that a CPU trains in a minute or two."""
    from lerobot.configs.types import NormalizationMode  # pyright: ignore[reportMissingImports]
    from lerobot.policies.act.configuration_act import (  # pyright: ignore[reportMissingImports]
        ACTConfig,
    )

    return ACTConfig(
        device="cpu",
        push_to_hub=False,
        chunk_size=CHUNK,
        n_action_steps=CHUNK,
        # LeRobot leaves the environment's state as it is unless told.
        normalization_mapping=dict.fromkeys(
            ("VISUAL", "STATE", "ENV", "ACTION"), NormalizationMode.MEAN_STD
        ),
        # Weights from elsewhere would have to be downloaded; there is no camera either.
        pretrained_backbone_weights=None,
        dim_model=64,
        n_heads=4,
        dim_feedforward=128,
        n_encoder_layers=2,
        # The expert has one way of doing it, so there is no style to be inferred.
        use_vae=False,
        dropout=0.0,
        optimizer_lr=1e-3,
        optimizer_weight_decay=1e-4,
    )
