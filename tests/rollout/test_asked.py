"""What episodes ask of somebody: requests, turns, waits, driving and labels, each apart."""

from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.rollout.asked import AskedInEpisode, asked_in, asked_in_all
from sheath_manip.types import Actor, Episode, Outcome, Reason
from tests.episodes import episode_of

ACTORS = {
    "p": (Actor.POLICY, Reason.INSIDE, 0.0),
    "o": (Actor.OPERATOR, Reason.PERSON, 0.0),
    "O": (Actor.OPERATOR, Reason.PERSON, 1.5),
    "w": (Actor.HOLD, Reason.WAITING, 0.0),
    "i": (Actor.HOLD, Reason.IDLE, 0.0),
    "n": (Actor.FALLBACK, Reason.NO_ANSWER, 0.0),
    "N": (Actor.FALLBACK, Reason.NO_ANSWER, 10.0),
    "s": (Actor.FALLBACK, Reason.SPARED, 0.0),
}
"""O came, and N did not, after the robot had stood still"""


def attended(letters: str) -> Episode:
    episode = episode_of("p" * len(letters))
    steps = []
    for step, letter in zip(episode.steps, letters, strict=True):
        actor, reason, waited_s = ACTORS[letter]
        decision = replace(step.decision, actor=actor, reason=reason, waited_s=waited_s)
        steps.append(replace(step, decision=decision))
    return replace(episode, steps=tuple(steps))


@pytest.mark.parametrize(
    ("letters", "requests", "turns", "waited_s"),
    [
        ("pppp", 0, [], 0.0),
        ("ppOooopp", 1, [4], 1.5),
        # Unasked, he drives a turn, and answers nothing.
        ("pooopp", 0, [3], 0.0),
        # Handed back too soon: asked anew.
        ("pOoOop", 2, [4], 3.0),
        # Held step by step, as a robot is.
        ("pwwwoop", 1, [2], 0.3),
        ("pNnnpp", 1, [3], 10.0),
        # With no wait at all the fallback acts at once.
        ("pnnp", 1, [2], 0.0),
        ("pwwnnp", 1, [2], 0.2),
        # The budget is spent: nobody is asked.
        ("pOopssp", 1, [2, 2], 1.5),
        ("pOoiiop", 1, [2, 1], 1.5),
    ],
)
def test_requests_turns_and_waits_are_told_apart(letters, requests, turns, waited_s):
    asked = asked_in(attended(letters))
    assert asked.requests == requests
    assert [round(turn_s, 6) for turn_s in asked.turns_s] == [turn / 10 for turn in turns]
    assert asked.waited_s == pytest.approx(waited_s)
    assert asked.length_s == pytest.approx(len(letters) / 10)


def test_a_scripted_expert_is_asked_where_its_turn_begins():
    asked = asked_in(episode_of("ppeeppeee", labelled="xx.......".replace(".", " ")))
    assert (asked.requests, len(asked.turns_s), asked.labels) == (2, 2, 2)
    # It demonstrates unasked.
    assert asked_in(episode_of("eeee", policy=False)).requests == 0


def test_all_together():
    episodes = [
        AskedInEpisode(Outcome.SUCCESS, 30.0, 3, (1.0, 2.0, 6.0), 3.0, 40),
        AskedInEpisode(Outcome.FAILURE, 60.0, 0, (), 0.0, 2),
    ]
    asked = asked_in_all(episodes)
    assert asked.requests_a_minute == 2.0
    assert asked.requests_an_episode == 1.5
    assert (asked.median_turn_s, asked.driven_s, asked.waited_s) == (2.0, 9.0, 3.0)
    assert asked.labels == 42
    assert np.isnan(asked_in_all([]).requests_a_minute)
