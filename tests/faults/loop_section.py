"""Runs the cases of faults in the control loop over loop and store, and judges what became of them.

A case is survived where the run came to its end in time, by an episode or by one line; what the
environment saw is in the store to the bit; and nothing that was executed left its bounds. It is
told of where the recording, a line, or the error names who failed.
"""

import tempfile
import time
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

import numpy as np

from sheath_manip.dataset.recorder import Recorder
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import SheathError
from sheath_manip.rollout.loop import rollout
from sheath_manip.types import Actor, Episode, EpisodeInfo, Outcome, Purpose
from tests.faults.counting import Count, Verdict, counted
from tests.faults.loop_cases import HANG_S, Case, Cast, all_cases, few_of
from tests.faults.parts import Witness, lines
from tests.toy import ACTION, hold

MOST_S = 10 * HANG_S + 8.0
"""of a case: a hang is broken off after HANG_S, and the machine may be busy"""


def counts(quick: bool) -> Mapping[str, Count]:
    """Run all cases, or two of each kind; return the counts by kind."""
    cases = all_cases()
    return counted(verdicts(few_of(cases, 2, seed=0) if quick else cases))


def verdicts(cases: Iterable[Case]) -> Iterator[Verdict]:
    """Run cases, each over a store of its own."""
    for number, case in enumerate(cases):
        with tempfile.TemporaryDirectory() as directory:
            verdict = verdict_of(case, Path(directory) / "store", number)
        if not (verdict.survived and verdict.told):
            print(f"NOT {'TOLD' if verdict.survived else 'SURVIVED'}: {verdict.case}", flush=True)
        yield verdict


def verdict_of(case: Case, path: Path, seed: int) -> Verdict:
    """Run one case."""
    cast, store = case.cast(), EpisodeStore.create(path)
    witness = cast.environment
    while not isinstance(witness, Witness):
        witness = witness.part
    info = EpisodeInfo("corridor", seed, Purpose.LEARNING, 50.0, "faults")
    error: BaseException | None = None
    began_s = time.monotonic()
    with lines() as told:
        try:
            _run(cast, info, store, seed)
        except Exception as raised:
            error = raised
    took_s = time.monotonic() - began_s
    episodes = [store.read(name) for name in store.names()]
    faults = list(_faults(case, witness, episodes, error, took_s))
    cast_met = cast.faulty is None or cast.faulty.met
    where = f"{case.kind}: {case.name} ({case.gate}): "
    if not cast_met:
        faults.append("the fault was never met")
    said = case.silent or _names_who(case, episodes, error, told)
    return Verdict(case.kind, not faults, said, where + ("; ".join(faults) or f"{error} {told}"))


def _run(cast: Cast, info: EpisodeInfo, store: EpisodeStore, seed: int) -> None:
    rollout(
        cast.environment,
        info,
        cast.gate,
        rng=np.random.default_rng(seed),
        policy=cast.policy,
        expert=cast.expert,
        hold=hold(cast.environment),
        listeners=(Recorder(store), *cast.listeners),
        deadline=cast.deadline,
    )


def _faults(
    case: Case,
    witness: Witness,
    episodes: list[Episode],
    error: BaseException | None,
    took_s: float,
) -> Iterator[str]:
    if took_s > MOST_S:
        yield f"took {took_s:.1f} s"
    if error is not None and not isinstance(error, SheathError):
        yield f"{type(error).__name__} came through: a traceback"
    if error is not None and len(str(error).splitlines()) != 1:
        yield "more than one line"
    if (error is not None) != case.ends:
        yield f"ended by {error!r}"
    if not witness.done_actions:
        return
    if len(episodes) != 1:
        yield f"{len(episodes)} episodes in the store"
        return
    episode = episodes[0]
    if (episode.outcome is Outcome.ERROR) != case.ends:
        yield f"outcome {episode.outcome}"
    in_time = case.times == 1 and case.method != "outcome"
    if case.ends and in_time and episode.steps[-1].decision.actor is not Actor.HOLD:
        yield "nobody held the robot"
    yield from _differences(witness, episode, unseen=case.part == "environment")


def _differences(witness: Witness, episode: Episode, unseen: bool) -> Iterator[str]:
    """What the recording says otherwise than the environment; `unseen`: it did a step untold."""
    # A step whose answer never came, or was rubbish, is no step: the loop cannot know of it.
    done = list(zip(witness.done_actions, witness.shown, strict=False))
    missing = len(done) - len(episode)
    if not 0 <= missing <= (9 if unseen else 0):
        yield f"{len(episode)} steps recorded of {len(done)} that were done"
    place = 0
    for step in episode.steps:
        inside = (step.executed >= ACTION.minimum) & (step.executed <= ACTION.maximum)
        if not inside.all():
            yield f"executed {step.executed} out of bounds"
        while place < len(done) and not (
            np.array_equal(done[place][0], step.executed)
            and (unseen or np.array_equal(done[place][1].features, step.observation.features))
        ):
            place += 1
        if place == len(done):
            yield "the recording holds what was not done"
            return
        if not unseen and not np.array_equal(
            done[place][1].images["above"], step.observation.images["above"]
        ):
            yield "the recording holds another image than was shown"
            return
        if (
            not unseen
            and step.state.tolist() != [place, step.observation.features[0]]
            and not (np.isclose(step.state[1], step.observation.features[0]))
        ):
            yield "the recording holds another state than there was"
            return
        place += 1


def _names_who(
    case: Case, episodes: list[Episode], error: BaseException | None, told: list[str]
) -> bool:
    who = "run" if case.part == "listener" else case.part
    recorded = {
        each.who for episode in episodes for step in episode.steps for each in step.decision.broken
    } | {episode.cut_short_by.who for episode in episodes if episode.cut_short_by is not None}
    if case.part == "listener":
        return any("listener" in line for line in told)
    if case.ends:
        in_store = who in recorded or not episodes
        return in_store and error is not None and who in str(error)
    return who in recorded and any(who in line for line in told)
