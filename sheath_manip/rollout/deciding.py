"""Policy and gate as the loop asks them: whatever they do, a proposal or none, and a decision."""

from dataclasses import replace

import numpy as np

from sheath_manip.exceptions import ActionError
from sheath_manip.protocols import Follows, Gate, Policy, Replans
from sheath_manip.rollout.checking import kept_proposal, shown_to_policy
from sheath_manip.rollout.guard import LATE, BrokenError, Foreign
from sheath_manip.rollout.watch import present_watch
from sheath_manip.types import (
    ActionSpec,
    Actor,
    Breakdown,
    GateDecision,
    Observation,
    Proposal,
    Reason,
    SignalScore,
)

POLICY, GATE = "policy", "gate"


class GuardedPolicy:
    """Proposes, or says why there is no proposal."""

    def __init__(self, policy: Policy, spec: ActionSpec) -> None:
        self.policy = policy
        self.spec = spec
        self._follows = isinstance(policy, Follows)
        self._replans = isinstance(policy, Replans)
        self._interrupted = False
        self._foreign = Foreign(POLICY)

    def reset(self, rng: np.random.Generator) -> None:
        """Begin an episode; a policy that cannot proposes nothing in it."""
        self._interrupted = False
        self._foreign.begin(self.policy.reset, rng)

    def interrupt(self) -> None:
        """Note that somebody else acts in this step: what the policy planned is void."""
        self._interrupted = True

    def propose(self, observation: Observation) -> tuple[Proposal | None, Breakdown | None]:
        """Look at an observation: what may be executed, else what broke down.

        A proposal that comes too late is none: the state that it is for has passed.
        """
        try:
            proposal = self._foreign.ask(self._propose, observation)
        except BrokenError as error:
            return None, error.breakdown
        watch = present_watch()
        if watch is not None and watch.late:
            return None, Breakdown(POLICY, LATE)
        return proposal, None

    def _propose(self, observation: Observation) -> Proposal:
        interrupted, self._interrupted = self._interrupted, False
        if interrupted and self._replans:
            self.policy.replan()  # pyright: ignore[reportAttributeAccessIssue]
        if self._follows:
            self.policy.follow(observation)  # pyright: ignore[reportAttributeAccessIssue]
        return kept_proposal(self.policy.propose(shown_to_policy(observation)), self.spec)


def reason_without_proposal(broken: Breakdown | None) -> Reason:
    """Return why somebody else acts where the policy proposed nothing to be executed."""
    if broken is None or broken.what == ActionError.__name__:
        return Reason.INVALID_PROPOSAL
    return Reason.TOO_LATE if broken.what == LATE else Reason.POLICY_FAILED


class GuardedGate:
    """Decides as a gate does, and for `instead` where that fails, or lets the policy act too late.

    It goes around a gate once more where another gate is made of it: so that one hears of a
    decision even where the inner one breaks down.
    """

    def __init__(self, gate: Gate, instead: Actor = Actor.EXPERT) -> None:
        self.gate = gate
        self.instead = instead
        self._foreign = Foreign(GATE)

    def reset(self, rng: np.random.Generator) -> None:
        """Forget the last episode; a gate that cannot decides nothing in the next."""
        self._foreign.begin(self.gate.reset, rng)

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Ask the gate."""
        try:
            decision = self._foreign.ask(self._decide, observation, proposal)
        except BrokenError as error:
            return self._other(Reason.GATE_FAILED, error.breakdown)
        if decision.actor is not Actor.POLICY:
            return decision
        if proposal is None:
            # The loop knows why; a gate must not be trusted to have looked.
            return self._other(Reason.INVALID_PROPOSAL)
        watch = present_watch()
        # A gate with a person in it has judged that inside, where the person can be asked.
        if watch is not None and watch.late and self.instead is Actor.EXPERT:
            late = self._other(Reason.TOO_LATE, Breakdown(GATE, LATE))
            score, threshold = decision.score, decision.threshold
            return replace(late, score=score, threshold=threshold, signals=decision.signals)
        return decision

    def _decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        return kept_decision(self.gate.decide(observation, proposal))

    def _other(self, reason: Reason, *broken: Breakdown) -> GateDecision:
        query = self.instead is Actor.EXPERT
        return GateDecision(self.instead, query, reason, broken=broken)


def kept_decision(decision: object) -> GateDecision:
    """Return the decision, its score and threshold as numbers; raises TypeError where it is none.

    Raises ValueError for an actor or a reason that there is none of.
    """
    if not isinstance(decision, GateDecision):
        raise TypeError(f"wanted a GateDecision, got {type(decision).__name__}")
    if not all(isinstance(each, Breakdown) for each in decision.broken):
        raise TypeError("wanted what broke down as Breakdown")
    if not all(isinstance(each, SignalScore) for each in decision.signals):
        raise TypeError("wanted what the score is made of as SignalScore")
    if (
        isinstance(decision.score, float)
        and isinstance(decision.threshold, float)
        and type(decision.actor) is Actor
        and type(decision.reason) is Reason
        and type(decision.query) is bool
    ):
        return decision
    return replace(
        decision,
        actor=Actor(decision.actor),
        query=bool(decision.query),
        reason=Reason(decision.reason),
        score=float(decision.score),
        threshold=float(decision.threshold),
    )
