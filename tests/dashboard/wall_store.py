"""Episodes on the ring road that a wall has something to tell of."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from sheath_manip.dashboard import Replay
from sheath_manip.dashboard.catalog import EpisodeCatalog
from sheath_manip.dataset.marks import Marks
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.playback.clip import clip
from sheath_manip.playback.film import Film, film_of
from sheath_manip.playback.making import exported
from sheath_manip.types import Outcome, SignalScore, Step
from tests.dashboard.conftest import SPEC, TOKEN, RingRoad, drive
from tests.waiting import DEADLINE_S

STEPS = 60
OUTCOMES = (Outcome.FAILURE, Outcome.TIME_LIMIT, Outcome.SUCCESS, Outcome.SUCCESS)
NOTE = "slips <b>here</b>"
RARE = 0.004
"""share of held-out expert steps that score lower than any step here"""


def wall_store(path: Path) -> EpisodeStore:
    """One episode of each of OUTCOMES, of two methods; the last one has a note at its step 5."""
    store = EpisodeStore.create(path)
    driven = drive(RingRoad(), STEPS)
    whole = replace(driven, steps=tuple(map(_with_signal, driven.steps)))
    for index, outcome in enumerate(OUTCOMES):
        method = "sheath" if index % 2 == 0 else "dagger"
        info = replace(whole.info, index=index, method=method)
        store.append(replace(whole, info=info, outcome=outcome))
    store.mark(EpisodeCatalog(store).source(0)[1], Marks().with_note(5, NOTE))
    return store


def _with_signal(step: Step) -> Step:
    signal = SignalScore("support", step.decision.score, RARE)
    return replace(step, decision=replace(step.decision, signals=(signal,)))


def replay_of(*stores: EpisodeStore) -> Replay:
    """The replay page of what was driven on the ring road."""
    catalog, environment = EpisodeCatalog(*stores), RingRoad()

    def film_at(place: int) -> Film:
        return film_of(environment, catalog.read(place))

    return Replay(
        SPEC,
        catalog,
        film_at,
        lambda place, kind: exported(film_at(place), None, kind),
        lambda place, *rest: clip(film_at(place), None, *rest),
        port=0,
        token=TOKEN,
    )


@contextmanager
def running_replay(store: EpisodeStore) -> Iterator[Replay]:
    """The replay page while it runs, on a thread of its own."""
    with replay_of(store) as page:
        run = threading.Thread(target=page.run, args=(0,), daemon=True)
        run.start()
        yield page
    run.join(DEADLINE_S)
    assert not run.is_alive()
