"""A* on a grid: (column, row), moves right, down, left, up."""

from math import dist, inf

import pytest

from sheath_manip.controllers.astar import AStar
from sheath_manip.exceptions import ParameterError

MOVES = ((1, 0), (0, 1), (-1, 0), (0, -1))


def search(rows: str, **settings) -> AStar[tuple[int, int]]:
    """Free tiles are dots, the goal an x."""
    grid = rows.split()
    goal = next((row.index("x"), y) for y, row in enumerate(grid) if "x" in row)

    def successor(place: tuple[int, int], move: int) -> tuple[int, int] | None:
        x, y = place[0] + MOVES[move][0], place[1] + MOVES[move][1]
        inside = 0 <= y < len(grid) and 0 <= x < len(grid[0])
        return (x, y) if inside and grid[y][x] != "#" else None

    def estimate(place: tuple[int, int]) -> float:
        return dist(place, goal)

    return AStar(
        actions=4,
        cost=lambda move, place: 1.0,  # noqa: ARG005
        successor=successor,
        estimate=estimate,
        key=lambda place: place,
        **settings,
    )


MAZE = """
..#.....
..#.###.
......#x
"""


def test_the_shortest_way_at_weight_1():
    plan = search(MAZE, weight=1.0).plan((0, 0))
    assert plan.complete
    assert len(plan.actions) == 13
    assert plan.states[0] == (0, 0)
    assert plan.states[-1] == (7, 2)


def test_actions_lead_along_the_states():
    maze = search(MAZE)
    plan = maze.plan((0, 0))
    for before, action, behind in zip(plan.states, plan.actions, plan.states[1:], strict=False):
        assert maze.successor(before, action) == behind
    assert maze.plan((0, 0)) == plan


def test_a_clear_way_makes_no_other_states():
    plan = search("." * 20 + "x").plan((0, 0))
    assert (len(plan.actions), plan.nodes) == (20, 20)


def test_the_goal_is_its_own_plan():
    plan = search(MAZE).plan((7, 2))
    assert (plan.complete, plan.actions, plan.states) == (True, (), ((7, 2),))


@pytest.mark.parametrize("most_nodes", [1, 3, 10])
def test_out_of_nodes_it_goes_towards_the_goal(most_nodes):
    plan = search("." * 20 + "x", most_nodes=most_nodes).plan((0, 0))
    assert (plan.complete, plan.nodes, plan.states[-1]) == (False, most_nodes, (most_nodes, 0))


def test_an_incomplete_plan_ends_where_it_may_rest():
    def even(place: tuple[int, int]) -> bool:
        return place[0] % 2 == 0

    plan = search("." * 20 + "x", most_nodes=7, rests=even).plan((0, 0))
    assert plan.states[-1] == (6, 0)


def test_walled_in_it_says_so():
    plan = search(".#x").plan((0, 0))
    assert (plan.complete, plan.actions) == (False, ())


@pytest.mark.parametrize("settings", [{"weight": 0.5}, {"most_nodes": 0}, {"weight": -inf}])
def test_wrong_settings_are_refused(settings):
    with pytest.raises(ParameterError, match="wanted"):
        search(MAZE, **settings)
