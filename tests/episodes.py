"""Episodes told by letters, for tests of what is read off who acted when."""

from collections.abc import Mapping

import numpy as np

from sheath_manip.types import (
    Actor,
    Episode,
    EpisodeInfo,
    GateDecision,
    Observation,
    Outcome,
    Purpose,
    Reason,
    Step,
)

INFO = EpisodeInfo("toy", 7, Purpose.LEARNING, 10.0)
ACTION = np.array([0.1], np.float32)


def episode_of(
    actors: str,
    labelled: str = "",
    *,
    info: EpisodeInfo = INFO,
    outcome: Outcome = Outcome.SUCCESS,
    metrics: Mapping[str, float] | None = None,
    policy: bool = True,
    side_px: int = 0,
) -> Episode:
    """One step a letter; the expert's action is minus the policy's.

    Args:
        actors: p policy, e expert; the gate scored 0.1 for the one and -0.1 for the other.
        labelled: x where the expert labelled, by default where it acted.
        info: its seed also colours the images.
        outcome: how it ended.
        metrics: one lap by default.
        policy: False where none proposed, as in a demonstration.
        side_px: height and width of the pictures of a camera "top"; 0 for no camera.
    """
    rng = np.random.default_rng(info.seed)

    def observation(number: int) -> Observation:
        images = {}
        if side_px:
            image = np.full((side_px, side_px, 3), (70, 120, 60), np.uint8)
            patch = slice(side_px * 3 // 8, side_px * 5 // 8)
            image[patch, patch] = rng.integers(0, 255, image[patch, patch].shape)
            images["top"] = image
        return Observation(images, np.zeros(1, np.float32), number / info.control_rate_hz)

    def step(number: int, actor: str, label: str) -> Step:
        expert = actor == "e"
        decision = GateDecision(
            actor=Actor.EXPERT if expert else Actor.POLICY,
            query=label == "x",
            reason=Reason.OUTSIDE if expert else Reason.INSIDE,
            score=-0.1 if expert else 0.1,
            threshold=0.0,
        )
        return Step(
            observation=observation(number),
            state=np.zeros(2),
            proposed=ACTION if policy else None,
            labelled=-ACTION if label == "x" else None,
            decision=decision,
            executed=-ACTION if expert else ACTION,
            reward=0.0,
        )

    letters = zip(actors, labelled or actors.replace("e", "x"), strict=True)
    return Episode(
        info=info,
        steps=tuple(step(number, *pair) for number, pair in enumerate(letters)),
        final_observation=observation(len(actors)),
        final_state=np.zeros(2),
        terminated=True,
        truncated=False,
        outcome=outcome,
        metrics={"laps": 1.0} if metrics is None else metrics,
    )
