"""What is counted of LeRobot's policy in our loop."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from sheath_manip.adapters.lerobot_policy import LeRobotPolicy
from sheath_manip.gates.constant import AlwaysPolicy
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.gates.making import make_gate
from sheath_manip.metrics import expert_share, figures_of, record_of
from sheath_manip.types import Episode, Purpose
from tools.lerobot.gates import Overheard
from tools.lerobot.scenes import Scenes


def passes_alone(scenes: Scenes, policy: LeRobotPolicy, count: int) -> tuple[list[Episode], int]:
    """Return the episodes that a policy drives alone, and how often its network was asked."""
    asked: list[None] = []
    network = policy.chunks.policy.model  # pyright: ignore[reportAttributeAccessIssue]
    hook = network.register_forward_hook(lambda *_: asked.append(None))
    try:
        infos = [scenes.info(Purpose.EVALUATION, "start", 0, index) for index in range(count)]
        episodes = [scenes.run(info, AlwaysPolicy(), policy) for info in infos]
    finally:
        hook.remove()
    return episodes, len(asked)


def judged_as_given(
    scenes: Scenes, policy: LeRobotPolicy, gate: FittedGate, count: int
) -> dict[str, Any]:
    """Return of gated episodes in how many of the policy's steps its judged action was given.

    Given is what the environment was handed, judged what the gate was shown; equal is equal to the
    bit.
    """
    overheard = Overheard(make_gate(gate))
    steps = same = 0
    records = []
    for index in range(count):
        info = scenes.info(Purpose.LEARNING, "judged", 99, index)
        episode = scenes.run(info, overheard, policy)
        records.append(record_of(episode))
        for judged, given in zip(overheard.judged, scenes.environment.given, strict=True):
            if judged is not None:
                steps += 1
                same += judged.tobytes() == given.tobytes()
    return {
        "episodes": count,
        "policy_steps": steps,
        "judged_is_given": same,
        "success_rate": figures_of(records).success_rate,
        "expert_share": expert_share(records),
    }


def told_of(episodes: Sequence[Episode]) -> dict[str, Any]:
    """Return success, burden and length of some episodes."""
    records = [record_of(episode) for episode in episodes]
    figures = figures_of(records)
    return {
        "episodes": figures.episodes,
        "success_rate": figures.success_rate,
        "success_ci95": list(figures.ci95["success_rate"]),
        "failure_rate": figures.failure_rate,
        "expert_share": expert_share(records),
        "takeovers_an_episode": float(np.mean([record.interventions for record in records])),
        "labels": sum(record.queries for record in records),
        "steps": sum(record.steps for record in records),
    }
