"""The intervention worth showing: where the expert did what the policy would not have done."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import StoreError
from sheath_manip.playback.frames import side_by_side
from sheath_manip.policies.deviation import largest_deviations
from sheath_manip.types import Action, ActionSpec, Episode, Outcome, Purpose

CONTEXT_S = 0.6
"""of the policy before and after that make an intervention one that can be seen"""
CHATTER_S = 0.3
"""of the policy that do not end an intervention"""
LONGEST_S = 2.4
"""longer ones show nothing more"""

Pictures = Callable[[Episode, Sequence[int]], Sequence[NDArray[np.uint8]]]
"""(h, w, 3) RGB of moments of an episode of T steps, all of one size: 0 .. T - 1 before a step, T
after the last one"""


class NothingToShowError(StoreError):
    """The store lacks the episodes that a figure is about; the other figures do not suffer."""


def recorded(episode: Episode, indices: Sequence[int]) -> Sequence[NDArray[np.uint8]]:
    """Return what the cameras saw, side by side; raises NothingToShowError where there was none."""
    if not episode.final_observation.images:
        raise NothingToShowError(
            f"{episode.info.task} was seen by no camera; wanted images, or Task(picture=...)"
        )
    seen = (*(step.observation for step in episode.steps), episode.final_observation)
    return [side_by_side(seen[index].images) for index in indices]


@dataclass(frozen=True)
class View:
    """How a task's steps are shown, and which of its actions look the same."""

    pictures: Pictures = recorded
    action: ActionSpec | None = None
    """whose tolerance counts; None: only equal actions are the same"""

    def disagreed(self, episode: Episode) -> NDArray[np.bool_]:
        """(t,) where the policy wanted something else than the expert's label."""
        return np.array([self._differ(step.proposed, step.labelled) for step in episode.steps])

    def _differ(self, proposed: Action | None, labelled: Action | None) -> bool:
        if proposed is None or labelled is None:
            return False
        if self.action is None or self.action.tolerance == 0:
            return not np.allclose(proposed, labelled, atol=1e-4)
        off = largest_deviations(self.action, proposed[None], labelled[None])
        return bool(off[0] > self.action.tolerance)


AS_RECORDED = View()


@dataclass(frozen=True, eq=False)
class Intervention:
    """A run of steps in which the expert acts, with at most short breaks, and its episode."""

    episode: Episode
    start: int
    """first step of the expert"""
    stop: int
    """first step after it"""
    view: View

    @property
    def expert_s(self) -> float:
        """How long the expert acted, breaks left out."""
        acted = int(expert_acted(self.episode)[self.start : self.stop].sum())
        return acted / self.episode.info.control_rate_hz

    @property
    def window(self) -> slice:
        """The steps to show: the run, or the first of it, with what led to it and what followed."""
        context, longest = _steps(self.episode, CONTEXT_S), _steps(self.episode, LONGEST_S)
        stop = min(self.stop, self.start + longest) + context
        return slice(max(self.start - context, 0), min(stop, len(self.episode.steps)))


def best_intervention(
    store: EpisodeStore,
    method: str = "sheath",
    view: View = AS_RECORDED,
    wanted: Callable[[Episode, int, int], bool] = lambda *_: True,
) -> Intervention:
    """The one to show, images included, of all of `method` that are `wanted`.

    Of an episode, the expert's first step and the first after it `wanted` says whether it is about
    what is to be shown. Raises NothingToShowError.

    Rather one in an episode that succeeded, with the policy driving before and after, in which the
    policy wanted something else than the expert for as many steps as possible.
    """
    best: tuple[tuple, Episode, int, int] | None = None
    for episode in store.episodes(Purpose.LEARNING, method, need_images=False):
        expert = expert_acted(episode)
        context, longest = _steps(episode, CONTEXT_S), _steps(episode, LONGEST_S)
        for start, stop in _runs(expert, _steps(episode, CHATTER_S)):
            framed = start >= context and not expert[start - context : start].any()
            framed = framed and stop + context <= len(expert)
            framed = framed and not expert[stop : stop + context].any()
            differing = sum(view.disagreed(episode)[start : min(stop, start + longest)])
            rank = (
                episode.outcome is Outcome.SUCCESS,
                framed,
                stop - start <= longest,
                differing,
                stop - start,
            )
            if (best is None or rank > best[0]) and wanted(episode, start, stop):
                best = rank, episode, start, stop
    if best is None:
        raise NothingToShowError(
            f"{store.path} holds no intervention of {method}; run its rounds first"
        )
    _, episode, start, stop = best
    return Intervention(store.read(episode_name(episode.info)), start, stop, view)


def expert_acted(episode: Episode) -> NDArray[np.bool_]:
    """(t,) where somebody else than the policy acted."""
    return np.logical_not(episode.columns.by_policy)


def _steps(episode: Episode, duration_s: float) -> int:
    return round(duration_s * episode.info.control_rate_hz)


def _runs(expert: NDArray[np.bool_], chatter: int) -> list[tuple[int, int]]:
    """(start, stop) of each run of the expert's steps; breaks of up to `chatter` end none."""
    joined: list[tuple[int, int]] = []
    edges = np.flatnonzero(np.diff(np.concatenate([[False], expert, [False]]).astype(int)))
    for start, stop in edges.reshape(-1, 2).tolist():
        if joined and start - joined[-1][1] <= chatter:
            joined[-1] = (joined[-1][0], stop)
        else:
            joined.append((start, stop))
    return joined
