"""Plays a recorded episode to a listener as if it ran now."""

import time

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Environment, Listener
from sheath_manip.types import Episode


def replay(
    listener: Listener, environment: Environment, episode: Episode, speed: float = 1.0
) -> None:
    """Restore each recorded state in `environment` and tell `listener` of each step.

    Args:
        listener: the dashboard, for one; it may hold the replay paused.
        environment: of the same task; it is reset to the episode's seed.
        episode: as recorded.
        speed: 1 plays at the episode's control rate, 2 twice as fast.

    Raises:
        ParameterError: a speed that is not positive, or an episode of another task.
    """
    if not speed > 0:
        raise ParameterError(f"the replay's speed is {speed}; wanted more than 0, such as 1")
    if episode.info.task != environment.spec.name:
        raise ParameterError(
            f"the episode is of task {episode.info.task!r}, the environment of "
            f"{environment.spec.name!r}; wanted both of one task"
        )
    environment.reset(episode.info.seed)
    if episode.steps:
        environment.restore(episode.steps[0].state)
    listener.on_start(environment, episode.info)
    period_s = 1 / (episode.info.control_rate_hz * speed)
    due_s = time.monotonic()
    # A step's own state is the one before its action; a listener is told after it.
    states_after = [step.state for step in episode.steps[1:]] + [episode.final_state]
    for step, state in zip(episode.steps, states_after, strict=True):
        environment.restore(state)
        listener.on_step(environment, step)
        # What a pause or a slow machine took is not caught up.
        due_s = max(due_s + period_s, time.monotonic())
        time.sleep(max(0.0, due_s - time.monotonic()))
    listener.on_end(episode)
