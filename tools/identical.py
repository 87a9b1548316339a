"""Whether two episodes are the same to the bit."""

import numpy as np

from sheath_manip.types import Episode, Observation, Step


def identical(a: Episode, b: Episode) -> bool:
    """Whether two episodes are the same to the bit, NaN and the sign of zero included."""
    return _as_bits(a) == _as_bits(b)


def _as_bits(episode: Episode) -> list[object]:
    """All of an episode as values whose equality is equality of bits."""

    def bits(array: np.ndarray | float | None) -> object:
        value = np.asarray(array)
        return None if array is None else (str(value.dtype), value.shape, value.tobytes())

    def seen(observation: Observation) -> list[object]:
        images = {camera: bits(image) for camera, image in observation.images.items()}
        numbers = [bits(value) for value in (observation.features, observation.time_s)]
        return [images, *numbers, observation.instruction]

    def done(step: Step) -> list[object]:
        decision = step.decision
        actions = [bits(action) for action in (step.proposed, step.labelled, step.executed)]
        numbers = [bits(value) for value in (decision.score, decision.threshold, step.reward)]
        gate = [decision.actor, decision.query, decision.reason, decision.broken]
        limits = [(each.limit, bits(each.by)) for each in step.limited]
        return [*seen(step.observation), bits(step.state), *actions, *numbers, *gate, limits]

    return [
        episode.info,
        [done(step) for step in episode.steps],
        seen(episode.final_observation),
        bits(episode.final_state),
        (episode.terminated, episode.truncated, episode.outcome, episode.cut_short_by),
        {name: bits(value) for name, value in episode.metrics.items()},
    ]
