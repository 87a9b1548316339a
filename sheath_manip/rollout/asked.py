"""What episodes ask of the person, or of what stands in its place: each burden counted apart."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sheath_manip.metrics import runs_of
from sheath_manip.types import Actor, Episode, Outcome, Reason
from sheath_manip.types.columns import ACTORS, REASONS

MINUTE_S = 60.0
_ASKS = [REASONS.index(each) for each in (Reason.WAITING, Reason.NO_ANSWER)]


@dataclass(frozen=True)
class AskedInEpisode:
    """What one episode asked."""

    outcome: Outcome
    length_s: float
    """of the robot's time, waits not counted"""
    requests: int
    """how often the robot asked: for the expert, or for a person, whether one came or not"""
    turns_s: tuple[float, ...]
    """each turn of those who drove in the place of the policy"""
    waited_s: float
    """for a person, in which nobody drove"""
    labels: int


@dataclass(frozen=True)
class Asked:
    """What a set of episodes asked."""

    episodes: int
    requests: int
    requests_a_minute: float
    """of the robot's time; NaN where there was none"""
    requests_an_episode: float
    median_turn_s: float
    """NaN where nobody had one"""
    driven_s: float
    waited_s: float
    labels: int


def asked_in(episode: Episode) -> AskedInEpisode:
    """Return what `episode` asked.

    The expert of a gate is asked where its turn begins; a person where the robot stands still for
    it or holds. Who takes over unasked drives a turn, and answers no request.
    """
    columns, period_s = episode.columns, 1 / episode.info.control_rate_hz
    by_gate = columns.intervention & (columns.actor == ACTORS.index(Actor.EXPERT))
    stood = columns.waited_s > 0
    held = columns.held & (columns.reason == REASONS.index(Reason.WAITING))
    asked = np.isin(columns.reason, _ASKS) | stood
    # A wait is a request of its own, also where it comes in a turn that was handed back too soon.
    begun = {first for first, _ in runs_of(asked)} | set(np.flatnonzero(stood).tolist())
    driven = columns.intervention & columns.in_place_of_policy
    return AskedInEpisode(
        outcome=episode.outcome,
        length_s=len(episode) * period_s,
        requests=len(runs_of(by_gate)) + len(begun),
        turns_s=tuple((stop - first) * period_s for first, stop in runs_of(driven)),
        waited_s=float(columns.waited_s.sum() + held.sum() * period_s),
        labels=int(columns.has_label.sum()),
    )


def asked_in_all(episodes: Sequence[AskedInEpisode]) -> Asked:
    """Return what all of them asked together."""
    requests = sum(each.requests for each in episodes)
    minutes = sum(each.length_s for each in episodes) / MINUTE_S
    turns_s = [turn_s for each in episodes for turn_s in each.turns_s]
    return Asked(
        episodes=len(episodes),
        requests=requests,
        requests_a_minute=requests / minutes if minutes else float("nan"),
        requests_an_episode=requests / len(episodes) if episodes else float("nan"),
        median_turn_s=float(np.median(turns_s)) if turns_s else float("nan"),
        driven_s=sum(turns_s),
        waited_s=sum(each.waited_s for each in episodes),
        labels=sum(each.labels for each in episodes),
    )
