"""All who may act in the policy's place, and who acts where one of them fails."""

from collections.abc import Mapping
from dataclasses import replace

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Expert, Follows, TakesOver
from sheath_manip.rollout.guard import LATE, BrokenError, Foreign
from sheath_manip.rollout.watch import present_watch
from sheath_manip.types import (
    Action,
    ActionSpec,
    Actor,
    Breakdown,
    GateDecision,
    Observation,
    Reason,
)


class GuardedActor:
    """One who may act: its answers are actions, or a BrokenError."""

    def __init__(self, expert: Expert, who: str, spec: ActionSpec) -> None:
        self.expert = expert
        self.spec = spec
        self._follows = isinstance(expert, Follows)
        self._takes_over = isinstance(expert, TakesOver)
        self._foreign = Foreign(who)
        self._lost: BrokenError | None = None
        """why it does not know the present step"""

    def reset(self) -> None:
        """Begin an episode."""
        self._lost = None
        self._foreign.begin(self.expert.reset)

    def follow(self, observation: Observation) -> None:
        """See a step; who fails in that cannot act in it."""
        if not self._follows:
            return
        try:
            self._foreign.ask(self.expert.follow, observation)  # pyright: ignore[reportAttributeAccessIssue]
            self._lost = None
        except BrokenError as error:
            self._lost = error.again()

    def act(self, observation: Observation, begins: bool) -> Action:
        """(a,) what it would do; `begins` tells it that its turn does."""
        if self._lost is not None:
            raise self._lost.again()
        if begins and self._takes_over:
            self._foreign.ask(self.expert.take_over, observation)  # pyright: ignore[reportAttributeAccessIssue]
        return self._foreign.ask(self._act, observation)

    def _act(self, observation: Observation) -> Action:
        return self.spec.validated(self.expert.act(observation))


class Actors:
    """Everyone but the policy; each is asked at most once a step."""

    def __init__(
        self, actors: Mapping[Actor, Expert], hold: Expert | None, spec: ActionSpec
    ) -> None:
        """Store who there is; `hold` brings the robot to rest where nobody else is left."""
        guarded: dict[int, GuardedActor] = {}
        for actor, one in actors.items():
            guarded.setdefault(id(one), GuardedActor(one, str(actor), spec))
        self._actors = {actor: guarded[id(one)] for actor, one in actors.items()}
        self._hold = None if hold is None else GuardedActor(hold, str(Actor.HOLD), spec)
        self._each = [*guarded.values(), *([] if self._hold is None else [self._hold])]
        self._acted: Actor | None = None

    @property
    def operated(self) -> bool:
        """Whether a person is among them, who is to be asked before anybody else drives."""
        return Actor.OPERATOR in self._actors

    @property
    def can_hold(self) -> bool:
        """Whether there is one that brings the robot to rest."""
        return self._hold is not None

    def reset(self) -> None:
        """Begin an episode."""
        self._acted = None
        for each in self._each:
            each.reset()

    def follow(self, observation: Observation) -> None:
        """Let those see the step who want to."""
        for each in self._each:
            each.follow(observation)

    def policy_acts(self) -> None:
        """Note that it is nobody's turn here."""
        self._acted = Actor.POLICY

    def label(self, observation: Observation) -> Action:
        """(a,) what the expert would do; raises BrokenError, and ParameterError without one."""
        return self._one(Actor.EXPERT).act(observation, begins=False)

    def act(self, decision: GateDecision, observation: Observation) -> tuple[GateDecision, Action]:
        """Let the one act that the decision names, or another one where that one fails.

        Returns who did in the end, and what. Raises BrokenError where nobody is left, and
        ParameterError where the gate wants one that was never there.
        """
        decision = self._within_reach(decision)
        try:
            return self._acting(decision, observation)
        except BrokenError as error:
            other = self._after(decision.actor)
            if other is None:
                raise
            broken = (*decision.broken, error.breakdown)
            instead = replace(
                decision, actor=other, query=False, reason=Reason.ACTOR_FAILED, broken=broken
            )
            return self._acting(instead, observation)

    def _acting(
        self, decision: GateDecision, observation: Observation
    ) -> tuple[GateDecision, Action]:
        actor = decision.actor
        if actor is Actor.HOLD and decision.reason in _RESCUES:
            one = self._rescuer()
        else:
            one = self._one(actor)
        begins, self._acted = actor is not self._acted, actor
        action = one.act(observation, begins)
        watch = present_watch()
        if watch is not None and watch.late and not decision.broken:
            # Nobody is better placed: what is late is recorded, and executed.
            return replace(decision, broken=(Breakdown(str(actor), LATE),)), action
        return decision, action

    def _rescuer(self) -> GuardedActor:
        if self._hold is not None:
            return self._hold
        if self.operated:
            # Where a simulation cannot hold, somebody else stands there, who would drive.
            raise BrokenError("run", "no hold", "nobody is there to hold the robot")
        return self._one(Actor.HOLD)

    def _within_reach(self, decision: GateDecision) -> GateDecision:
        """Where policy or gate failed, one acts that there is."""
        if decision.reason not in _RESCUES or decision.actor in self._actors:
            return decision
        for actor in (Actor.FALLBACK, Actor.HOLD):
            if actor in self._actors or (actor is Actor.HOLD and self.can_hold):
                return replace(decision, actor=actor, query=False)
        return decision

    def _after(self, failed: Actor) -> Actor | None:
        if failed is Actor.EXPERT and Actor.FALLBACK in self._actors and not self.operated:
            return Actor.FALLBACK
        if failed is Actor.OPERATOR and self.can_hold:
            return Actor.HOLD
        return None

    def _one(self, actor: Actor) -> GuardedActor:
        one = self._actors.get(actor)
        if one is None:
            raise ParameterError(
                f"the gate asks for the {actor}, but the rollout was given none (or the policy "
                "proposed no valid action and nobody can take over)"
            )
        return one


_RESCUES = (
    Reason.INVALID_PROPOSAL,
    Reason.POLICY_FAILED,
    Reason.GATE_FAILED,
    Reason.ACTOR_FAILED,
    Reason.ENVIRONMENT_FAILED,
    Reason.TOO_LATE,
)
