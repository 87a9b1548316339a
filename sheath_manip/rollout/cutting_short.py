"""What is done where nobody is left to act: bring the robot to rest, keep the attempt, say so."""

import logging
import math
from dataclasses import replace

from sheath_manip.dataset.naming import error_session
from sheath_manip.exceptions import AttemptError, SheathError, UnattendedError
from sheath_manip.rollout.actors import Actors
from sheath_manip.rollout.guard import BrokenError, ask
from sheath_manip.rollout.stage import ENVIRONMENT
from sheath_manip.rollout.stepping import Stepping
from sheath_manip.rollout.watch import present_watch
from sheath_manip.types import Actor, Breakdown, EpisodeInfo, GateDecision, Outcome, Reason

logger = logging.getLogger(__name__)

TO_REST_S = 1.0
"""for which the robot is held: its command filter brings it to rest in less"""


def cut_short(
    stepping: Stepping, actors: Actors, info: EpisodeInfo, error: SheathError
) -> SheathError:
    """Hold the robot, tell the listeners of what there is of the episode, return what to raise.

    A breakdown becomes an AttemptError; what was raised on purpose stays what it is. Where nobody
    attends the run it stands still already, and is not moved.
    """
    place = len(stepping.steps)
    broken = error.breakdown if isinstance(error, BrokenError) else None
    cut_by = broken or Breakdown("run", type(error).__name__)
    if not isinstance(error, UnattendedError):
        _bring_to_rest(stepping, actors, cut_by)
    watch = present_watch()
    if watch is not None:
        watch.end_steps()
    try:
        ask(ENVIRONMENT, stepping.stage.hold)
    except BrokenError as fault:
        logger.warning("%s where it was to hold the robot", fault)
    kept = "nothing of it is recorded"
    if stepping.steps:
        try:
            metrics = stepping.stage.metrics()
        except BrokenError:
            metrics = {stepping.stage.spec.metric: math.nan}
        session = error_session(info.session)
        episode = stepping.episode(replace(info, session=session), Outcome.ERROR, metrics, cut_by)
        stepping.audience.end(episode)
        if stepping.audience.keeps:
            kept = f"{len(episode)} steps are recorded with the outcome {Outcome.ERROR}"
    if broken is None:
        return error
    where = f"step {place} of the {info.purpose} episode of scene {info.seed}"
    return AttemptError(f"{error} in {where}; the robot was told to hold, the run ends, {kept}")


def _bring_to_rest(stepping: Stepping, actors: Actors, broken: Breakdown) -> None:
    """Hold for as long as it takes to come to rest, or until that fails as well."""
    if not (actors.can_hold and stepping.moved):
        return
    # The error that ends the run says so.
    stepping.telling.hush(broken)
    reason = Reason.ENVIRONMENT_FAILED if broken.who == ENVIRONMENT else Reason.ACTOR_FAILED
    decision = GateDecision(Actor.HOLD, False, reason, broken=(broken,))
    try:
        for _ in range(math.ceil(TO_REST_S * stepping.stage.spec.control_rate_hz)):
            if stepping.over:
                return
            observation = stepping.look()
            _, action = actors.act(decision, observation)
            stepping.step(None, action, decision)
            decision = replace(decision, broken=())
    except SheathError as error:
        logger.warning("%s while the robot was brought to rest", error)
