"""An intervention is one in tables, the store, playback and the page alike."""

from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.burden import counts_of
from sheath_manip.dashboard.tally import counts_of_trace
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.metrics import record_of, runs_of
from sheath_manip.playback.trace import GrowingTrace
from sheath_manip.types import (
    Actor,
    Episode,
    EpisodeInfo,
    GateDecision,
    Purpose,
    Reason,
    ScenePose,
    Step,
)
from tests.episodes import ACTION, episode_of

INFO = EpisodeInfo("toy", 7, Purpose.LEARNING, 10.0, "sheath", 1)
POSE = ScenePose(np.zeros((0, 7)))
WHO = {
    "p": (Actor.POLICY, Reason.INSIDE, True),
    "e": (Actor.EXPERT, Reason.OUTSIDE, True),
    # The policy proposed no action, so none is recorded.
    "i": (Actor.EXPERT, Reason.INVALID_PROPOSAL, False),
    "o": (Actor.OPERATOR, Reason.PERSON, True),
    "f": (Actor.FALLBACK, Reason.NO_ANSWER, True),
    "h": (Actor.HOLD, Reason.WAITING, True),
}


def told_by(letters: str, checkpoint: str = "0123456789abcdef", policy: bool = True) -> Episode:
    """One step a letter of `WHO`; an operator's steps alone are labels."""

    def step(plain: Step, letter: str) -> Step:
        actor, reason, proposed = WHO[letter]
        acts = actor is Actor.POLICY
        return replace(
            plain,
            proposed=ACTION if proposed and policy else None,
            labelled=None if acts else -ACTION,
            executed=ACTION if acts else -ACTION,
            decision=GateDecision(actor, actor is Actor.OPERATOR, reason, -0.1, 0.0),
        )

    plain = episode_of("p" * len(letters), info=replace(INFO, checkpoint=checkpoint))
    steps = tuple(step(*pair) for pair in zip(plain.steps, letters, strict=True))
    return replace(plain, steps=steps)


def counted(episode: Episode, store: EpisodeStore) -> dict[str, int]:
    """The interventions, as each of those says who count them."""
    name = store.append(episode)
    growing = GrowingTrace(episode.info)
    for step in episode.steps:
        growing.append(step, POSE)
    trace = growing.so_far()
    stored = store.recorded(name).arrays["intervention"]
    return {
        "table": record_of(episode).interventions,
        "read back": record_of(store.read(name)).interventions,
        "store": len(runs_of(np.asarray(stored))),
        "trace": len(trace.turns),
        "page": counts_of_trace(trace, 10.0).takeovers,
    }


@pytest.mark.parametrize(
    ("letters", "interventions"),
    [
        ("pppp", 0),
        ("pippipp", 2),
        ("pphhoopp", 1),
        ("phppfffp", 2),
        ("pihofep", 1),
        ("hhhh", 1),
        ("oooo", 1),
        ("i", 1),
        ("pipohpfpeh", 4),
    ],
)
@pytest.mark.parametrize("checkpoint", ["0123456789abcdef", ""])
def test_all_count_the_same(letters, interventions, checkpoint, tmp_path):
    episode = told_by(letters, checkpoint)
    found = counted(episode, EpisodeStore.create(tmp_path))
    assert found == dict.fromkeys(found, interventions)


def test_where_there_is_no_policy_nobody_intervenes(tmp_path):
    found = counted(told_by("ehoe", "", policy=False), EpisodeStore.create(tmp_path))
    assert found == dict.fromkeys(found, 0)


def test_to_hold_is_no_driving(tmp_path):
    episode = told_by("pihhofphp")
    record = record_of(episode)
    assert (record.steps, record.hold_steps, record.expert_steps) == (9, 3, 3)
    assert record.switches == 4
    store = EpisodeStore.create(tmp_path)
    name = store.append(episode)
    assert store.header(name).expert_steps == 3
    assert store.summary(name).expert_share == pytest.approx(3 / 9)
    growing = GrowingTrace(episode.info)
    for step in episode.steps:
        growing.append(step, POSE)
    assert counts_of_trace(growing.so_far(), 10.0) == counts_of(record)
