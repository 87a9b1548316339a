"""The one control loop: demonstrations, training, evaluation and teleoperation run through it."""

from collections.abc import Sequence

import numpy as np

from sheath_manip.exceptions import ActionError, ParameterError
from sheath_manip.protocols import (
    Environment,
    Expert,
    Follows,
    Gate,
    Listener,
    Proposer,
    TakesOver,
)
from sheath_manip.types import (
    Action,
    ActionSpec,
    Actor,
    Commanded,
    Episode,
    EpisodeInfo,
    GateDecision,
    Observation,
    Reason,
    Step,
)


def rollout(
    environment: Environment,
    info: EpisodeInfo,
    gate: Gate,
    *,
    rng: np.random.Generator,
    policy: Proposer | None = None,
    expert: Expert | None = None,
    listeners: Sequence[Listener] = (),
) -> Episode:
    """Run the episode of `info.seed` to its end.

    The policy proposes, the gate decides who acts and whether a label is asked for, and the expert
    is asked at most once a step. A proposal that is no action (NaN, out of bounds) hands the step
    to the expert. An expert that `Follows` sees every step, and one that `TakesOver` is told when
    its turn begins: this is the one place in which a turn starts.

    Raises ParameterError where the gate wants an expert or a policy that is not there, and
    ActionError where the expert's own action is none.
    """
    observation = environment.reset(info.seed)
    gate.reset(rng)
    if expert is not None:
        expert.reset()
    for listener in listeners:
        listener.on_start(environment, info)

    steps: list[Step] = []
    acted: Actor | None = None
    terminated = truncated = False
    while not (terminated or truncated):
        state = environment.state()
        if isinstance(expert, Follows):
            expert.follow(observation)
        proposed = _proposal(policy, observation, environment.spec.action)
        decision = gate.decide(observation, proposed)
        if proposed is None and decision.actor is Actor.POLICY:
            decision = GateDecision(Actor.EXPERT, True, Reason.INVALID_PROPOSAL)
        if policy is None and decision.reason is Reason.INVALID_PROPOSAL:
            raise ParameterError("the gate wants a policy, but the rollout was given none")
        if decision.actor is Actor.EXPERT is not acted and isinstance(expert, TakesOver):
            expert.take_over(observation)
        acted = decision.actor
        labelled = None
        if decision.query or decision.actor is Actor.EXPERT:
            labelled = _label(expert, observation, environment.spec.action)
        wished = labelled if decision.actor is Actor.EXPERT else proposed
        assert wished is not None
        transition = environment.step(wished)
        commanded = transition.commanded or Commanded(wished)
        step = Step(
            observation,
            state,
            proposed,
            labelled,
            decision,
            commanded.action,
            transition.reward,
            commanded.limited,
        )
        steps.append(step)
        observation = transition.observation
        terminated, truncated = transition.terminated, transition.truncated
        for listener in listeners:
            listener.on_step(environment, step)

    episode = Episode(
        info,
        tuple(steps),
        observation,
        environment.state(),
        terminated,
        truncated,
        environment.outcome(),
        environment.metrics(),
    )
    for listener in listeners:
        listener.on_end(episode)
    return episode


def _proposal(policy: Proposer | None, observation: Observation, spec: ActionSpec) -> Action | None:
    if policy is None:
        return None
    try:
        return spec.validated(policy.act(observation))
    except ActionError:
        return None


def _label(expert: Expert | None, observation: Observation, spec: ActionSpec) -> Action:
    if expert is None:
        raise ParameterError(
            "the gate asks for the expert, but the rollout was given none (or the policy proposed "
            "no valid action and nobody can take over)"
        )
    return spec.validated(expert.act(observation))
