"""Weighted A* over the successors of any simulator, made one at a time.

Weighted A* (Pohl, 1970) with partial expansion (Yoshizumi, Miura and Ishida, 2000): of a state that
comes up only the first action's successor is made, and the next action waits in the queue with the
state's own estimate. Where the way is clear, hardly more states are made than the plan has.
"""

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from heapq import heappop, heappush
from typing import Generic, TypeVar

from sheath_manip.exceptions import ParameterError

S = TypeVar("S")


@dataclass(frozen=True)
class Plan(Generic[S]):
    """A way through the states."""

    states: tuple[S, ...]
    """from the start on, one more than there are actions"""
    actions: tuple[int, ...]
    """indices of the actions between them"""
    complete: bool
    """it ends in a goal; otherwise in the most promising state that was found"""
    nodes: int
    """states that were made"""


@dataclass(frozen=True)
class AStar(Generic[S]):
    """A search problem: what to search in, and how hard. Costs and estimates share one unit."""

    actions: int
    """how many there are; a state's successors are made in their order"""
    cost: Callable[[int, S], float]
    """of an action that leads to a state"""
    successor: Callable[[S, int], S | None]
    """by action index; None where it is a dead end"""
    estimate: Callable[[S], float]
    """cost from a state to the goal, 0 in a goal only"""
    key: Callable[[S], Hashable]
    """states of one key count as the same"""
    rests: Callable[[S], bool] = bool
    """whether a plan that cannot be completed may end there; elsewhere only if nowhere else"""
    weight: float = 1.4
    """of the estimate: more is quicker and less thorough"""
    most_nodes: int = 240

    def __post_init__(self) -> None:
        if self.actions < 1 or self.weight < 1 or self.most_nodes < 1:
            raise ParameterError(
                f"{self.actions} actions, weight {self.weight}, {self.most_nodes} nodes; "
                "wanted at least one action, a weight of 1 or more and one node or more"
            )

    def plan(self, start: S) -> Plan[S]:
        """The way to the first goal that comes up, or towards one if `most_nodes` are spent."""
        states, ways, costs = [start], [(-1, -1)], [0.0]
        estimate = self.estimate(start)
        seen = {self.key(start): 0.0}
        # Of equal ones the newest first, which is the one farthest along.
        if estimate <= 0:
            return self._way(0, states, ways, complete=True)
        queue = [(self.weight * estimate, 0, 0, 0)]
        best, best_merit = 0, (False, -float("inf"))
        while queue and len(states) <= self.most_nodes:
            rank, _, node, action = heappop(queue)
            if action + 1 < self.actions:
                heappush(queue, (rank, -node, node, action + 1))
            state = self.successor(states[node], action)
            if state is None:
                continue
            cost = costs[node] + self.cost(action, state)
            key = self.key(state)
            if seen.get(key, float("inf")) <= cost:
                continue
            seen[key] = cost
            estimate = self.estimate(state)
            new = len(states)
            states.append(state)
            ways.append((node, action))
            costs.append(cost)
            if estimate <= 0:
                return self._way(new, states, ways, complete=True)
            merit = (self.rests(state), -estimate)
            if merit > best_merit:
                best, best_merit = new, merit
            heappush(queue, (cost + self.weight * estimate, -new, new, 0))
        return self._way(best, states, ways, complete=False)

    def _way(
        self, node: int, states: list[S], ways: list[tuple[int, int]], complete: bool
    ) -> Plan[S]:
        passed, actions = [states[node]], []
        while node:
            node, action = ways[node]
            passed.append(states[node])
            actions.append(action)
        return Plan(tuple(passed[::-1]), tuple(actions[::-1]), complete, len(states) - 1)
