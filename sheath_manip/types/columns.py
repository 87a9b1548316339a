"""The steps of an episode by column: what samples, counts, stores and figures are selections of."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.types.spec import Action
from sheath_manip.types.step import Actor, GateDecision, Reason, Step

ACTORS = tuple(Actor)
"""in the order of `Columns.actor`, whose numbers are places in it"""
REASONS = tuple(Reason)
"""in the order of `Columns.reason`, whose numbers are places in it"""
WITHOUT_PROPOSAL = (Reason.INVALID_PROPOSAL, Reason.POLICY_FAILED, Reason.TOO_LATE)
"""why somebody acts where a policy that there is has proposed nothing to be executed"""
_WITHOUT_PROPOSAL = np.array([reason in WITHOUT_PROPOSAL for reason in REASONS])
IN_PLACE_OF_POLICY = np.array([actor.in_place_of_policy for actor in ACTORS])
"""(actors,) by place: whether that one drives where the policy does not"""


@dataclass(frozen=True, eq=False)
class Columns:
    """T rows, one a step, all but the images; the arrays must not be written to."""

    time_s: NDArray[np.float64]
    """(T,) before the action"""
    features: NDArray[np.float32]
    """(T, f)"""
    state: NDArray[np.float64]
    """(T, s)"""
    proposed: NDArray[np.float32]
    """(T, a) NaN where there is none"""
    has_proposed: NDArray[np.bool_]
    """(T,)"""
    labelled: NDArray[np.float32]
    """(T, a) NaN where there is none"""
    has_labelled: NDArray[np.bool_]
    """(T,)"""
    executed: NDArray[np.float32]
    """(T, a)"""
    actor: NDArray[np.uint8]
    """(T,) place in ACTORS"""
    reason: NDArray[np.uint8]
    """(T,) place in REASONS"""
    query: NDArray[np.bool_]
    """(T,) whether a label was asked for"""
    score: NDArray[np.float64]
    """(T,) NaN where the gate computes none"""
    threshold: NDArray[np.float64]
    """(T,) NaN where the gate has none"""
    reward: NDArray[np.float64]
    """(T,)"""
    limited: NDArray[np.bool_]
    """(T,) whether a command filter changed the command"""
    intervention: NDArray[np.bool_]
    """(T,) whether somebody else than the policy acted, though there was one"""
    waited_s: NDArray[np.float64]
    """(T,) for how long a simulation stood still before the step, until a person came or not"""
    signals: Mapping[str, NDArray[np.float64]]
    """(T, 2) by signal: its score, and its share among expert steps; NaN where it has none"""

    @classmethod
    def of(cls, steps: Sequence[Step], driven: bool) -> "Columns":
        """Return the columns of `steps`, of an episode `driven` by a checkpoint or not.

        Raises ValueError where arrays of one kind have several shapes.
        """
        decisions = [step.decision for step in steps]
        width = steps[0].executed.size if steps else 0
        actor = np.array([ACTORS.index(decision.actor) for decision in decisions], np.uint8)
        reason = np.array([REASONS.index(decision.reason) for decision in decisions], np.uint8)
        has_proposed = np.array([step.proposed is not None for step in steps], bool)
        return cls(
            time_s=np.array([step.observation.time_s for step in steps], np.float64),
            features=stacked([step.observation.features for step in steps]),
            state=stacked([step.state for step in steps]),
            proposed=_filled([step.proposed for step in steps], width),
            has_proposed=has_proposed,
            labelled=_filled([step.labelled for step in steps], width),
            has_labelled=np.array([step.labelled is not None for step in steps], bool),
            executed=stacked([step.executed for step in steps]),
            actor=actor,
            reason=reason,
            query=np.array([bool(decision.query) for decision in decisions], bool),
            score=np.array([decision.score for decision in decisions], np.float64),
            threshold=np.array([decision.threshold for decision in decisions], np.float64),
            reward=np.array([step.reward for step in steps], np.float64),
            limited=np.array([bool(step.limited) for step in steps], bool),
            intervention=intervening(actor, reason, has_proposed, driven),
            waited_s=np.array([decision.waited_s for decision in decisions], np.float64),
            signals=_by_signal(decisions),
        )

    def __len__(self) -> int:
        return len(self.actor)

    @property
    def by_policy(self) -> NDArray[np.bool_]:
        """(T,) whether the policy acted."""
        return self.actor == ACTORS.index(Actor.POLICY)

    @property
    def held(self) -> NDArray[np.bool_]:
        """(T,) whether nobody drove and the robot was held."""
        return self.actor == ACTORS.index(Actor.HOLD)

    @property
    def in_place_of_policy(self) -> NDArray[np.bool_]:
        """(T,) whether expert, operator or fallback controller drove."""
        return IN_PLACE_OF_POLICY[self.actor]

    @property
    def has_label(self) -> NDArray[np.bool_]:
        """(T,) which steps there is something to learn from."""
        return self.query & self.has_labelled

    @property
    def labels(self) -> NDArray[np.float32]:
        """(T, a) what to learn from; NaN where there is nothing."""
        return np.where(self.has_label[:, None], self.labelled, np.nan).astype(self.labelled.dtype)


def intervening(
    actor: NDArray[np.uint8],
    reason: NDArray[np.uint8],
    has_proposed: NDArray[np.bool_],
    driven: bool,
) -> NDArray[np.bool_]:
    """Return (T,) whether somebody else than the policy acted, though there was one to act.

    Runs of such steps are the interventions: the one definition for tables, stores, pages and
    results. There was a policy where a checkpoint drove the episode (`driven`), where one proposed,
    and where its proposal was invalid, which is recorded as none.
    """
    has_policy = has_proposed | _WITHOUT_PROPOSAL[reason] | driven
    return has_policy & (actor != ACTORS.index(Actor.POLICY))


def intervened(step: Step, driven: bool) -> bool:
    """Tell of one step what `intervening` does of many."""
    actor, reason = step.decision.actor, step.decision.reason
    return bool(
        intervening(
            np.array([ACTORS.index(actor)], np.uint8),
            np.array([REASONS.index(reason)], np.uint8),
            np.array([step.proposed is not None]),
            driven,
        )[0]
    )


def stacked(rows: Sequence[NDArray]) -> NDArray:
    """Return (T, ...) as np.stack makes it, in half the time.

    Raises ValueError for several shapes.
    """
    if len({row.shape for row in rows}) != 1:
        raise ValueError("all must have the same shape")
    return np.concatenate(rows).reshape(len(rows), *rows[0].shape)


def _by_signal(decisions: Sequence[GateDecision]) -> dict[str, NDArray[np.float64]]:
    """(T, 2) by the name of each signal that any decision names, sorted."""
    named = {each.signal for decision in decisions for each in decision.signals}
    columns = {name: np.full((len(decisions), 2), np.nan) for name in sorted(named)}
    for at, decision in enumerate(decisions):
        for each in decision.signals:
            columns[each.signal][at] = each.score, each.share
    return columns


def _filled(actions: Sequence[Action | None], size: int) -> NDArray:
    """(T, size) with NaN where there is no action, so that no reader takes it for one."""
    there = [action for action in actions if action is not None]
    if len(there) == len(actions):
        return stacked(there)
    filled = np.full((len(actions), size), np.nan, dtype=np.float32)
    if there:
        rows = stacked(there)
        # A silent conversion would hide an action of another type.
        filled = filled.astype(np.result_type(filled, rows), copy=False)
        filled[[action is not None for action in actions]] = rows
    return filled
