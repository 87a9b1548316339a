"""A choice of episodes, of their steps and of their actions to export."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.broken_steps import broken_between
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.layout import has_label, layout
from sheath_manip.dataset.marks import Marks
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.dataset.steps import by_expert
from sheath_manip.dataset.waits import waits_between
from sheath_manip.exceptions import StoreError
from sheath_manip.types import Outcome


class ActionChoice(StrEnum):
    """The action that stands for `the` action, in formats that know one."""

    EXECUTED = "executed"
    """what was commanded, after the command filter where there is one"""
    REQUESTED = "requested"
    """what the actor asked for, before it: the one that replays"""
    LABELLED = "labelled"
    """by the expert: states that nobody labelled are left out"""


@dataclass(frozen=True)
class Selection:
    """A choice of what to take of a store; by default all of it."""

    successes: bool = False
    """only episodes that succeeded"""
    expert_steps: bool = False
    """only steps in which the expert acted"""
    rounds: tuple[int, ...] = ()
    """only episodes of these rounds; all where empty"""
    action: ActionChoice = ActionChoice.EXECUTED
    bad_steps: bool = False
    """also steps that a person marked as bad"""

    def takes(self, header: Header, marks: Marks) -> bool:
        """Return whether anything of that episode may be taken."""
        outcome = marks.outcome or header.outcome
        return (not self.successes or outcome is Outcome.SUCCESS) and (
            not self.rounds or header.info.round in self.rounds
        )

    def steps(self, recorded: Recorded, marks: Marks) -> NDArray[np.bool_]:
        """(T,) which steps to take."""
        taken = np.ones(recorded.header.length, dtype=bool)
        if not self.bad_steps:
            taken &= ~marks.is_bad(recorded.header.length)
        if self.expert_steps:
            # Holding the robot in place of the expert gives no label.
            taken &= by_expert(recorded.header, recorded.arrays) & recorded.arrays["query"]
        if self.action is ActionChoice.LABELLED:
            taken &= has_label(recorded.arrays)
        return taken


def selected(reader: EpisodeReader, selection: Selection) -> Iterator[Recorded]:
    """Yield what is taken of each episode, read when asked for, in the order (round, index, name).

    Where steps in the middle are left out, each run of those taken is an episode of its own, so
    that consecutive frames stay consecutive in time. Raises StoreError where an episode is damaged,
    and where nothing at all is taken.
    """
    headers = {name: reader.header(name) for name in reader.names()}
    order = sorted(headers, key=lambda n: (headers[n].info.round, headers[n].info.index, n))
    some = False
    for name in order:
        marks = reader.marks(name)
        if selection.takes(headers[name], marks):
            recorded = _as_marked(reader.recorded(name), marks)
            for start, stop in runs(selection.steps(recorded, marks)):
                some = True
                yield piece(recorded, start, stop)
    if not some:
        raise StoreError(
            f"of the {len(order)} episodes in {reader.address} nothing is selected; "
            "ask for less, or see `sheath data list`"
        )


def _as_marked(recorded: Recorded, marks: Marks) -> Recorded:
    """The episode with the outcome that a person gave it."""
    if marks.outcome is None:
        return recorded
    return replace(recorded, header=replace(recorded.header, outcome=marks.outcome))


def runs(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """The runs of True as (start, stop), the latter exclusive."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return [(int(start), int(stop)) for start, stop in edges.reshape(-1, 2)]


def piece(recorded: Recorded, start: int, stop: int) -> Recorded:
    """The steps `start` .. `stop` (exclusive) as an episode of their own.

    Its method tells from which step it is, and its final observation is that of step `stop`. One
    cut off before the end of the whole counts as truncated, since nothing ended there.
    """
    header, arrays = recorded.header, recorded.arrays
    if (start, stop) == (0, header.length):
        return recorded
    last = stop == header.length
    cut = {}
    for spec in layout(header):
        if not spec.path.startswith("final/"):
            cut[spec.path] = arrays[spec.path][start:stop]
        else:
            before = arrays[spec.path.removeprefix("final/")]
            cut[spec.path] = arrays[spec.path] if last else np.asarray(before[stop])
    return Recorded(
        replace(
            header,
            info=replace(header.info, method=f"{header.info.method}-from{start:04d}"),
            length=stop - start,
            expert_steps=int(by_expert(header, arrays)[start:stop].sum()),
            queries=int(cut["query"].sum()),
            terminated=header.terminated and last,
            truncated=header.truncated or not last,
            # At step T is what cut the whole short.
            broken=broken_between(header.broken, start, stop + last),
            waits=waits_between(header.waits, start, stop),
        ),
        cut,
    )
