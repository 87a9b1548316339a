"""LeRobot's own loop: its queue, its pipelines, and nothing of ours but the scenes."""

from pathlib import Path

import numpy as np
import torch

from sheath_manip.protocols import Environment
from sheath_manip.types import Outcome
from tools.lerobot.sets import ENVIRONMENT, STATE


def own_episode(policy: Path, environment: Environment, seed: int, robot: int) -> tuple[str, int]:
    """Return how an episode ends in which LeRobot's `select_action` drives, and its steps.

    As in its evaluation script: reset, then each step one action out of its own queue.
    """
    from lerobot.policies.act.modeling_act import (  # pyright: ignore[reportMissingImports]
        ACTPolicy,
    )
    from lerobot.policies.factory import (  # pyright: ignore[reportMissingImports]
        make_pre_post_processors,
    )

    act = ACTPolicy.from_pretrained(policy)
    before, after = make_pre_post_processors(act.config, pretrained_path=str(policy))
    bounds = environment.spec.action
    observation, steps = environment.reset(seed), 0
    act.reset()
    while True:
        seen = torch.from_numpy(observation.features)
        with torch.inference_mode():
            action = act.select_action(before({STATE: seen[:robot], ENVIRONMENT: seen[robot:]}))
        wanted = after(action)[0].numpy()
        transition = environment.step(np.clip(wanted, bounds.minimum, bounds.maximum))
        observation, steps = transition.observation, steps + 1
        if transition.terminated or transition.truncated:
            return Outcome(environment.outcome()).value, steps
