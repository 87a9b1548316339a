"""The one control loop: demonstrations, training, evaluation and teleoperation run through it."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from sheath_manip.exceptions import ActionError, ParameterError
from sheath_manip.protocols import (
    Environment,
    Expert,
    Follows,
    Gate,
    Listener,
    Policy,
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
    Proposal,
    Reason,
    Step,
)

NOBODY: Mapping[Actor, Expert] = {}


def rollout(
    environment: Environment,
    info: EpisodeInfo,
    gate: Gate,
    *,
    rng: np.random.Generator,
    policy: Policy | None = None,
    expert: Expert | None = None,
    others: Mapping[Actor, Expert] = NOBODY,
    listeners: Sequence[Listener] = (),
) -> Episode:
    """Run the episode of `info.seed` to its end.

    The policy looks once and proposes, the gate judges that proposal and decides who acts and
    whether a label is asked for, and the one who acts is asked at most once a step: the expert, or
    of the `others` the operator, the fallback controller, or the one that holds the robot. A
    proposal that is no action (NaN, out of bounds) hands the step to the expert. Who `Follows` sees
    every step, and who `TakesOver` is told when its turn begins: this is the one place in which a
    turn starts.

    Raises ParameterError where the gate wants an actor or a policy that is not there, and
    ActionError where the action of one in the policy's place is none.
    """
    actors = {**({} if expert is None else {Actor.EXPERT: expert}), **others}
    each = list({id(one): one for one in actors.values()}.values())
    observation = environment.reset(info.seed)
    if policy is not None:
        # Apart from the gate's draws, which stay what they are whatever the policy draws.
        policy.reset(rng.spawn(1)[0])
    gate.reset(rng)
    for one in each:
        one.reset()
    for listener in listeners:
        listener.on_start(environment, info)

    steps: list[Step] = []
    acted: Actor | None = None
    terminated = truncated = False
    spec = environment.spec.action
    while not (terminated or truncated):
        state = environment.state()
        for one in (*each, policy):
            if isinstance(one, Follows):
                one.follow(observation)
        proposal = _proposal(policy, observation, spec)
        decision = gate.decide(observation, proposal)
        if proposal is None and decision.actor is Actor.POLICY:
            decision = GateDecision(Actor.EXPERT, True, Reason.INVALID_PROPOSAL)
        if policy is None and decision.reason is Reason.INVALID_PROPOSAL:
            raise ParameterError("the gate wants a policy, but the rollout was given none")
        turn = actors.get(decision.actor)
        if decision.actor is not acted and isinstance(turn, TakesOver):
            turn.take_over(observation)
        acted = decision.actor
        labelled = None
        if decision.actor is not Actor.POLICY:
            labelled = _asked(actors, decision.actor, observation, spec)
        elif decision.query:
            labelled = _asked(actors, Actor.EXPERT, observation, spec)
        proposed = None if proposal is None else proposal.now[0]
        requested = proposed if decision.actor is Actor.POLICY else labelled
        assert requested is not None
        transition = environment.step(requested)
        commanded = transition.commanded or Commanded(requested)
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


def _proposal(policy: Policy | None, observation: Observation, spec: ActionSpec) -> Proposal | None:
    """What the policy proposes, with the validated action in it: judged is what may be executed."""
    if policy is None:
        return None
    proposal = policy.propose(observation.alone)
    try:
        first = proposal.actions[0]
        chunked = np.ndim(first) > 1
        first = first[0] if chunked else first
        action = spec.validated(first)
    except (ActionError, IndexError, TypeError, ValueError):
        return None
    if action is first and isinstance(proposal.actions, np.ndarray):
        return proposal
    if not chunked:
        return replace(proposal, actions=action[None])
    actions = np.array(proposal.actions, np.float32)
    actions[0, 0] = action
    return replace(proposal, actions=actions)


def _asked(
    actors: Mapping[Actor, Expert], actor: Actor, observation: Observation, spec: ActionSpec
) -> Action:
    if actor not in actors:
        raise ParameterError(
            f"the gate asks for the {actor}, but the rollout was given none (or the policy "
            "proposed no valid action and nobody can take over)"
        )
    return spec.validated(actors[actor].act(observation))
