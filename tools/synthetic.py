"""Synthetic episodes: noise, but the same one wherever it is asked for again."""

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


def synthetic_info(run: int, index: int) -> EpisodeInfo:
    """Where the synthetic episode `index` of run `run` comes from."""
    return EpisodeInfo(
        task="synthetic",
        seed=1000 * run + index,
        purpose=Purpose.LEARNING,
        control_rate_hz=10.0,
        method="noise",
        index=index,
        run_seed=run,
    )


def synthetic_episode(info: EpisodeInfo, length: int = 40, pixels: int = 32) -> Episode:
    """An episode of noise with one square camera; the same `info` gives the same one."""
    rng = np.random.default_rng(info.seed)

    def observation(t: int) -> Observation:
        image = rng.integers(0, 256, (pixels, pixels, 3), dtype=np.uint8)
        return Observation({"front": image}, rng.random(6, np.float32), t / info.control_rate_hz)

    def step(t: int) -> Step:
        expert = bool(rng.random() < 0.3)
        decision = GateDecision(
            actor=Actor.EXPERT if expert else Actor.POLICY,
            query=expert,
            reason=Reason.OUTSIDE if expert else Reason.INSIDE,
            score=float(rng.normal()) if t else float("nan"),
            threshold=0.0,
        )
        proposed, executed = rng.random((2, 2), np.float32)
        return Step(
            observation=observation(t),
            state=rng.random(9),
            proposed=proposed,
            labelled=executed if expert else None,
            decision=decision,
            executed=executed if expert else proposed,
            reward=float(rng.random()),
        )

    return Episode(
        info=info,
        steps=tuple(step(t) for t in range(length)),
        final_observation=observation(length),
        final_state=rng.random(9),
        terminated=False,
        truncated=True,
        outcome=Outcome.TIME_LIMIT,
        metrics={"distance_m": float(rng.random())},
    )
