"""LeRobot's own loop: its queue, its pipelines, and nothing of ours but the scenes."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch

from sheath_manip.protocols import Environment
from sheath_manip.types import Outcome
from tools.lerobot.sets import ENVIRONMENT, STATE


def own_episodes(
    policy: Path, environment: Environment, seeds: Sequence[int], robot: int
) -> list[tuple[str, int]]:
    """Return how episodes end in which LeRobot's `select_action` drives, and their steps.

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
    ended = []
    for seed in seeds:
        observation, steps, over = environment.reset(seed), 0, False
        act.reset()
        while not over:
            seen = torch.from_numpy(observation.features)
            batch = before({STATE: seen[:robot], ENVIRONMENT: seen[robot:]})
            with torch.inference_mode():
                action = after(act.select_action(batch))[0].numpy()
            transition = environment.step(np.clip(action, bounds.minimum, bounds.maximum))
            observation, steps = transition.observation, steps + 1
            over = transition.terminated or transition.truncated
        ended.append((Outcome(environment.outcome()).value, steps))
    return ended
