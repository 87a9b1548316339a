"""A store of any number of synthetic episodes that are told at a glance and have no steps."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from sheath_manip.dataset.compatibility import RecordedSpec
from sheath_manip.dataset.faults import Fault
from sheath_manip.dataset.glance import EpisodeSummary
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.moments import EpisodeMoments, NearMiss, Takeover
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.reader import LARGEST_FILE_BYTES, EpisodeReader
from sheath_manip.exceptions import StoreError
from sheath_manip.types import Actor, Outcome, Reason
from tools.synthetic import synthetic_info

STEPS = 300
_METHODS = ("sheath", "dagger", "hg-dagger", "random-takeover")
_REASONS = (Reason.OUTSIDE, Reason.RISK, Reason.STUCK, Reason.PERSON)
_OUTCOMES = (Outcome.SUCCESS, Outcome.SUCCESS, Outcome.FAILURE, Outcome.TIME_LIMIT)


class SyntheticStore(EpisodeReader):
    """Index entries without episodes: what a page makes of many, without the disk for them."""

    def __init__(self, count: int) -> None:
        spec = RecordedSpec("synthetic", 10.0, {}, 6, 2, None)
        self._summaries = dict[str, EpisodeSummary]()
        for index in range(count):
            method = _METHODS[index % len(_METHODS)]
            info = replace(synthetic_info(index // 100, index % 100), method=method)
            name, outcome = episode_name(info), _OUTCOMES[index // 7 % len(_OUTCOMES)]
            self._summaries[name] = EpisodeSummary(
                name, info, STEPS, outcome, outcome, 0, 0.1, 30, {}, 1000, spec
            )

    @property
    def address(self) -> str:
        """A name for the page."""
        return "synthetic"

    def names(self) -> list[str]:
        """The names, sorted."""
        return sorted(self._summaries)

    def summaries(self) -> Iterator[EpisodeSummary | StoreError]:
        """Yield all at a glance."""
        yield from (self._summaries[name] for name in self.names())

    def moments(self, name: str) -> EpisodeMoments:
        """Return two takeovers and a near miss, at random but always the same."""
        rng = np.random.default_rng(abs(self._summaries[name].info.seed))
        starts = np.sort(rng.choice(STEPS - 20, 2, replace=False)).tolist()
        return EpisodeMoments(
            tuple(
                Takeover(
                    start,
                    start + 10,
                    _REASONS[int(rng.integers(len(_REASONS)))],
                    Actor.EXPERT,
                    round(-float(rng.random()), 4),
                )
                for start in starts
            ),
            (NearMiss(int(rng.integers(STEPS)), round(float(rng.random()) / 10, 4)),),
        )

    def header(self, name: str) -> Header:
        """Raise StoreError: there is nothing more of an episode."""
        raise self._nothing(name)

    def files(self, name: str) -> Mapping[str, int]:
        """Raise StoreError."""
        raise self._nothing(name)

    def content(self, name: str, file: str, most_bytes: int = LARGEST_FILE_BYTES) -> bytes:
        """Raise StoreError."""
        del file, most_bytes
        raise self._nothing(name)

    def entry_faults(self) -> list[Fault]:
        """Nothing is wrong."""
        return []

    def _nothing(self, name: str) -> StoreError:
        return StoreError(f"{name} is synthetic and has no steps; look at it at a glance only")
