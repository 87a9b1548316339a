"""What a worker process does: it runs the episodes that are asked of it, one after the other.

An episode is on the disk before it is answered for, so a worker may be lost at any time.
"""

import multiprocessing
import os
import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path

from sheath_manip.dataset.recorder import Recorder
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import SheathError, WorkerError
from sheath_manip.rollout.request import EpisodeRequest
from sheath_manip.rollout.threads import single_threaded
from sheath_manip.rollout.workplace import Workplace
from sheath_manip.types import Episode


@dataclass(frozen=True)
class Errand:
    """What is asked of a worker."""

    request: EpisodeRequest
    store: Path | None
    """where the episode is recorded"""


@dataclass(frozen=True, eq=False)
class Answer:
    """What came of it."""

    episode: Episode | None = None
    """without its images; None where it is in the store"""
    fault: SheathError | None = None


def serve(connection: Connection) -> None:
    """Answer errands until there are no more."""
    threading.Thread(target=end_with_parent, daemon=True).start()
    with single_threaded(), Workplace() as workplace:
        while True:
            try:
                errand: Errand = connection.recv()
                connection.send(answer_of(partial(run_errand, errand, workplace)))
            except (EOFError, OSError):
                # Who asked is gone, before this errand or while it was run.
                return


def without_images(episode: Episode) -> Episode:
    """Return the episode as it is counted, which is a hundredth of what it is to look at."""
    return replace(
        episode,
        steps=tuple(
            replace(step, observation=replace(step.observation, images={}))
            for step in episode.steps
        ),
        final_observation=replace(episode.final_observation, images={}),
    )


def answer_of(call: Callable[[], Answer]) -> Answer:
    """Return what `call` gives, or what went wrong in it as a line."""
    try:
        return call()
    except SheathError as error:
        # As text and of the root's kind: what an error holds of its own need not be picklable.
        return Answer(fault=WorkerError(str(error)))
    except Exception as error:
        return Answer(fault=WorkerError(f"{type(error).__name__}: {error}"))


def run_errand(errand: Errand, workplace: Workplace) -> Answer:
    """Run the episode and record it, or return it without its images."""
    if errand.store is None:
        return Answer(without_images(workplace.run(errand.request)))
    workplace.run(errand.request, (Recorder(EpisodeStore(errand.store)),))
    return Answer()


def end_with_parent() -> None:
    """A worker that outlived a killed run would write beside the one that resumes it."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
