"""The one control loop: demonstrations, training, evaluation and teleoperation run through it."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError, UnattendedError
from sheath_manip.protocols import Environment, Expert, Gate, Listener, Policy
from sheath_manip.rollout.actors import Actors
from sheath_manip.rollout.audience import Audience
from sheath_manip.rollout.cutting_short import cut_short
from sheath_manip.rollout.deciding import GuardedGate, GuardedPolicy, reason_without_proposal
from sheath_manip.rollout.guard import BrokenError
from sheath_manip.rollout.hindsight import Hindsight
from sheath_manip.rollout.stage import Stage
from sheath_manip.rollout.stepping import Stepping
from sheath_manip.rollout.telling import Telling
from sheath_manip.rollout.watch import Deadline, Watch, watched
from sheath_manip.types import (
    Actor,
    Breakdown,
    Episode,
    EpisodeInfo,
    GateDecision,
    Reason,
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
    hold: Expert | None = None,
    listeners: Sequence[Listener] = (),
    deadline: Deadline | None = None,
    begins: NDArray[np.float64] | None = None,
    hindsight_s: float = 0.0,
) -> Episode:
    """Run the episode of `info.seed` to its end.

    The policy looks once and proposes, the gate judges that proposal and decides who acts and
    whether a label is asked for, and the one who acts is asked at most once a step: the expert, or
    of the `others` the operator, the fallback controller, or the one that holds the robot. Who
    `Follows` sees every step, who `TakesOver` is told when its turn begins, and a policy that
    `Replans` that somebody else acted: this is the one place in which a turn starts.

    Whatever fails, somebody acts who can: in place of a policy or gate that raises, says rubbish or
    is late the expert, else the fallback controller, else `hold`; docs/reliability.md has the whole
    table. What broke down is in the step. A listener that raises is left out. Where nobody is left,
    or the environment fails, the robot is brought to rest by `hold`, and what there is of the
    episode is told to the listeners with the outcome ERROR.

    Args:
        environment: of the task.
        info: of the episode.
        gate: says who acts.
        rng: of the episode's draws.
        policy: proposes; None where nobody does.
        expert: labels, and acts where the gate says so.
        others: who else the gate may name.
        hold: leaves the robot where it is; None for a simulation that cannot.
        listeners: follow the episode.
        deadline: of each control step; None: nobody is late, and nothing that hangs is broken off.
        begins: (s,) a state of that episode, from which it goes on; None: from its start.
        hindsight_s: time before a failure that the expert labels afterwards; 0: none.

    Raises ParameterError where the gate wants an actor or a policy that was never there, and
    AttemptError where the episode was cut short.
    """
    audience = Audience(listeners)
    stage = Stage(environment)
    spec = stage.spec
    actors = Actors(
        {**({} if expert is None else {Actor.EXPERT: expert}), **others}, hold, spec.action
    )
    proposing = None if policy is None else GuardedPolicy(policy, spec.action)
    # A person is asked before anybody else drives.
    deciding = GuardedGate(gate, Actor.HOLD if actors.operated else Actor.EXPERT)
    steps = round(hindsight_s * spec.control_rate_hz)
    hindsight = Hindsight(steps) if steps and expert is not None else None
    watch = None if deadline is None else Watch(deadline, spec.control_rate_hz, stage.hold)
    with watched(watch):
        stepping = Stepping(stage, audience, Telling(info))
        try:
            stepping.begin(info.seed, begins)
            if proposing is not None:
                # Apart from the gate's draws, which stay what they are whatever the policy draws.
                proposing.reset(rng.spawn(1)[0])
            deciding.reset(rng)
            actors.reset()
            audience.start(environment, info)
            while not stepping.over:
                if watch is not None:
                    watch.begin_step(rests=not stepping.steps)
                control_step(stepping, proposing, deciding, actors, hindsight)
            if watch is not None:
                watch.end_steps()
            outcome, metrics = stage.outcome(), stage.metrics()
            if hindsight is not None:
                stepping.steps = hindsight.labelled(stepping.steps, outcome)
            episode = stepping.episode(info, outcome, metrics)
        except (BrokenError, ParameterError, UnattendedError) as error:
            raise cut_short(stepping, actors, info, error) from error
        audience.end(episode)
    return episode


def control_step(
    stepping: Stepping,
    policy: GuardedPolicy | None,
    gate: GuardedGate,
    actors: Actors,
    hindsight: Hindsight | None = None,
) -> None:
    """Run one step of the loop, for callers that go step by step: look, propose, judge, act.

    `hindsight` asks the expert about steps that get no label now.

    Raises BrokenError where nobody is left to act or the environment fails, and ParameterError
    where the gate wants an actor or a policy that was never there.
    """
    observation = stepping.look()
    actors.follow(observation)
    proposal, broken = (None, None) if policy is None else policy.propose(observation)
    decision = gate.decide(observation, proposal)
    if policy is None and decision.reason is Reason.INVALID_PROPOSAL:
        raise ParameterError("the gate wants a policy, but the rollout was given none")
    decision = _blamed(decision, broken)
    proposed = None if proposal is None else proposal.now[0]
    labelled = None
    if decision.actor is not Actor.POLICY:
        decision, labelled = actors.act(decision, observation)
        if policy is not None:
            policy.interrupt()
    else:
        actors.policy_acts()
        if decision.query:
            try:
                labelled = actors.label(observation)
            except BrokenError as error:
                # The policy may act, and a state more or less without a label does no harm.
                decision = replace(decision, broken=(*decision.broken, error.breakdown))
        elif hindsight is not None:
            hindsight.ask(len(stepping.steps), actors, observation)
    stepping.step(proposed, labelled, decision)


def _blamed(decision: GateDecision, broken: Breakdown | None) -> GateDecision:
    """The decision with what broke down before it, which is the reason where the gate knew none."""
    if broken is None:
        return decision
    reason = decision.reason
    if reason is Reason.INVALID_PROPOSAL:
        reason = reason_without_proposal(broken)
    return replace(decision, reason=reason, broken=(broken, *decision.broken))
