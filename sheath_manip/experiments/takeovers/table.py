"""The benchmark's table: at each burden the gate, and below it what asks as much and looks not."""

from collections.abc import Mapping
from typing import Any

from rich import box
from rich.console import Group
from rich.table import Table

from sheath_manip.experiments.table import with_interval
from sheath_manip.experiments.takeovers.plan import TAKEOVERS
from sheath_manip.playback.written import rounded

GATE = "gate"
"""the way beside which the others are baselines"""
NAMES = {
    GATE: "gate",
    "random-blocks": "  random blocks",
    "own-at-random-times": "  its own at random times",
    "another-scenes": "  another scene's",
    "random-steps": "  random steps",
    "every-kth-step": "  every k-th step",
}


def tables(summary: Mapping[str, Any]) -> Group:
    """Return one table a task."""
    return Group(*(_of_task(name, found) for name, found in summary["tasks"].items()))


def wanted(target: Mapping[str, Any]) -> str:
    """Return what a target holds equal, as it is written."""
    value = target["value"]
    return f"{value:g} an episode" if target["axis"] == TAKEOVERS else f"{100 * value:g} % share"


def _of_task(name: str, found: Mapping[str, Any]) -> Table:
    alone = found["policies"].values()
    grid = Table(
        title=f"{name}: scenes in which the policy fails alone",
        caption=f"policies alone: {sum(each['failing'] for each in alone)} of "
        f"{sum(each['episodes'] for each in alone)} episodes without success · failed: of the "
        "failing scenes, in % with its 95 % interval by scene · stuck: of these, the time was over",
        title_justify="left",
        caption_justify="left",
        box=box.SIMPLE_HEAD,
        padding=0,
        width=100,
    )
    grid.add_column("at", max_width=16)
    grid.add_column("who takes over", max_width=26)
    headers = ("failed %\n95 %", "of", "stuck", "take-\novers", "a\nmin", "share\n%", "turn\ns")
    for header in headers:
        grid.add_column(header, justify="right")
    for target in found["targets"]:
        for way, of in target["ways"].items():
            burden = of["burden"]
            grid.add_row(
                wanted(target) if way == GATE else "",
                NAMES[way],
                with_interval(100 * of["rate"], [100 * end for end in of["ci95"]]),
                str(of["scenes"]),
                str(of["stuck"]),
                *(_number(burden[key]) for key in ("takeovers_an_episode", "takeovers_a_minute")),
                _number(100 * of["expert_share"]),
                _number(burden["median_takeover_s"]),
            )
    oracle = found["oracle"]
    if oracle is not None and oracle["scenes"]:
        grid.caption = (
            f"{grid.caption} · the oracle, on {oracle['scenes']} of them: failed "
            f"{oracle['failed']}, {_number(oracle['burden']['takeovers_an_episode'])} takeovers, "
            f"{_number(100 * oracle['expert_share'])} % share"
        )
    return grid


def _number(value: float | None) -> str:
    return "–" if value is None else rounded(value)
