"""The intervention worth showing: where the expert did what the policy would not have done."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import StoreError
from sheath_manip.types import Actor, Episode, Outcome, Purpose

CONTEXT = 6
"""steps of the policy before and after that make an intervention one that can be seen"""
CHATTER = 3
"""steps of the policy that do not end an intervention"""
LONGEST = 24
"""steps; longer ones show nothing more"""


class NothingToShowError(StoreError):
    """The store lacks the episodes that a figure is about; the other figures do not suffer."""


@dataclass(frozen=True, eq=False)
class Intervention:
    """A run of steps in which the expert acts, with at most short breaks, and its episode."""

    episode: Episode
    start: int
    """first step of the expert"""
    stop: int
    """first step after it"""

    @property
    def expert_s(self) -> float:
        """How long the expert acted, breaks left out."""
        acted = int(expert_acted(self.episode)[self.start : self.stop].sum())
        return acted / self.episode.info.control_rate_hz

    @property
    def window(self) -> slice:
        """The steps to show: the run, or the first of it, with what led to it and what followed."""
        stop = min(self.stop, self.start + LONGEST) + CONTEXT
        return slice(max(self.start - CONTEXT, 0), min(stop, len(self.episode.steps)))


def best_intervention(store: EpisodeStore, method: str = "sheath") -> Intervention:
    """The one to show, images included, of all of `method`; raises NothingToShowError.

    Rather one in an episode that succeeded, with the policy driving before and after, in which the
    policy wanted something else than the expert for as many steps as possible.
    """
    best: tuple[tuple, Episode, int, int] | None = None
    for episode in store.episodes(Purpose.LEARNING, method, need_images=False):
        expert = expert_acted(episode)
        for start, stop in _runs(expert):
            framed = start >= CONTEXT and not expert[start - CONTEXT : start].any()
            framed = framed and stop + CONTEXT <= len(expert)
            framed = framed and not expert[stop : stop + CONTEXT].any()
            differing = sum(disagreed(episode)[start : min(stop, start + LONGEST)])
            rank = (
                episode.outcome is Outcome.SUCCESS,
                framed,
                stop - start <= LONGEST,
                differing,
                stop - start,
            )
            if best is None or rank > best[0]:
                best = rank, episode, start, stop
    if best is None:
        raise NothingToShowError(
            f"{store.path} holds no intervention of {method}; run its rounds first"
        )
    _, episode, start, stop = best
    episode = store.read(episode_name(episode.info))
    if not episode.final_observation.images:
        raise NothingToShowError(f"{episode.info.task} was seen by no camera; wanted images")
    return Intervention(episode, start, stop)


def disagreed(episode: Episode) -> NDArray[np.bool_]:
    """(t,) where the policy wanted something else than the expert's label."""
    return np.array(
        [
            step.proposed is not None
            and step.labelled is not None
            and not np.allclose(step.proposed, step.labelled, atol=1e-4)
            for step in episode.steps
        ]
    )


def expert_acted(episode: Episode) -> NDArray[np.bool_]:
    """(t,) where the expert drove."""
    return np.array([step.decision.actor is Actor.EXPERT for step in episode.steps])


def _runs(expert: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """(start, stop) of each run of the expert's steps; short breaks end none."""
    joined: list[tuple[int, int]] = []
    edges = np.flatnonzero(np.diff(np.concatenate([[False], expert, [False]]).astype(int)))
    for start, stop in edges.reshape(-1, 2).tolist():
        if joined and start - joined[-1][1] <= CHATTER:
            joined[-1] = (joined[-1][0], stop)
        else:
            joined.append((start, stop))
    return joined
