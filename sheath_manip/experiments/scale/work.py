"""An experiment as pieces of work: how long each takes, and what it has to wait for."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from sheath_manip.experiments.scale.costs import Costs
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.methods import method_named

Kind = Literal["fit", "recorded", "judging"]
"""in the order in which pieces go: what the next ones wait for goes first"""


@dataclass(frozen=True)
class Work:
    """A piece: one episode, or all that one process computes between two lots of them."""

    kind: Kind
    cpu_s: float
    after: tuple[int, ...]
    """places of the pieces that must be done before"""


class _Pieces:
    """The list as it grows."""

    def __init__(self, costs: Costs, plan: LearningPlan) -> None:
        self.all: list[Work] = []
        self.costs = costs
        self.plan = plan

    def add(self, kind: Kind, cpu_s: float, after: Sequence[int], count: int = 1) -> list[int]:
        first = len(self.all)
        self.all += [Work(kind, cpu_s, tuple(after))] * count
        return list(range(first, len(self.all)))


def work_of(costs: Costs, plan: LearningPlan) -> list[Work]:
    """Return all pieces of the experiment, as `sheath experiment` runs them.

    Each method of each seed fits in a process of its own, and asks shared workers for episodes;
    while the policy of a round is judged, the next round runs.
    """
    pieces = _Pieces(costs, plan)
    for _ in plan.comparison.seeds:
        _seed(pieces)
    return pieces.all


def _seed(pieces: _Pieces) -> None:
    costs, schedule = pieces.costs, pieces.plan.schedule
    held_out = schedule.calibration + schedule.false_alarm_episodes
    demonstrated = pieces.add("recorded", costs.expert_s, (), schedule.demonstrations)
    shown = demonstrated + pieces.add("recorded", costs.expert_s, (), held_out)
    states = schedule.demonstrations * costs.states_each
    first = pieces.add("fit", costs.fit.at(states), shown)
    judged = pieces.add("judging", costs.alone_s, first, pieces.plan.comparison.evaluation_episodes)
    rounds: dict[str, list[list[int]]] = {}
    names = sorted(
        pieces.plan.comparison.methods, key=lambda name: method_named(name).burden_from is not None
    )
    for name in names:
        followed = method_named(name).burden_from
        rounds[name] = _method(pieces, name, judged, states, rounds.get(followed or "", []))


def _method(
    pieces: _Pieces,
    name: str,
    after: Sequence[int],
    states: float,
    followed: Sequence[Sequence[int]],
) -> list[list[int]]:
    """The rounds of one method; return the episodes of each, whose share another is given."""
    costs, plan = pieces.costs.methods[name], pieces.plan
    comparison = plan.comparison
    rounds: list[list[int]] = []
    judged: list[int] = []

    def share(number: int) -> Sequence[int]:
        return followed[number - 1] if 0 < number <= len(followed) else ()

    driving = pieces.add("fit", costs.begin_s, [*after, *share(1)])
    measured: list[int] = []
    for number in range(1, plan.schedule.rounds + 1):
        driven = pieces.add("recorded", costs.episode_s, driving, plan.schedule.episodes)
        states += plan.schedule.episodes * costs.states_each
        # One process computes for a method: it has measured the round before.
        before = [*driven, *measured, *share(number + 1)]
        driving = pieces.add("fit", costs.fit.at(states), before)
        judging = pieces.add(
            "judging", pieces.costs.alone_s, driving, comparison.evaluation_episodes
        )
        # And it waits for the policy of the round before, which was judged meanwhile.
        measured = pieces.add("fit", costs.measure_s, [*driving, *judged])
        if number == plan.schedule.rounds:
            pieces.add("judging", pieces.costs.alone_s, measured, comparison.final_episodes)
        judged = judging
        rounds.append(driven)
    return rounds
