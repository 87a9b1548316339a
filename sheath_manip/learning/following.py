"""The burden that a method is given: by a schedule, or by the rounds of another method."""

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.places import is_there
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError
from sheath_manip.learning.asking import RunEpisodes
from sheath_manip.learning.methods import Method
from sheath_manip.learning.results import read_result, round_path
from sheath_manip.metrics import EpisodeRecord, record_of
from sheath_manip.types import Purpose

POLL_S = 0.2
"""between two looks for a round of another method"""


class GivenBurdens:
    """The gate's settings in the rounds of one training seed, where more than the plan says so."""

    def __init__(
        self, episodes: RunEpisodes, directory: Path, store: EpisodeStore, awaits: bool
    ) -> None:
        """Store where rounds lie.

        With `awaits` the rounds of a method that is followed run in another process: they are
        waited for, and their burden is known as soon as their episodes are recorded.
        """
        self._episodes = episodes
        self._directory = directory
        self._store = store
        self._awaits = awaits

    def of(self, method: Method, number: int) -> Mapping[str, Any]:
        """Return the gate's settings in a round that a schedule or another method says.

        ParameterError where the method follows another, which has no such round.
        """
        if method.share is not None:
            return {"expert_share": method.share(self._episodes.schedule, number)}
        if method.burden_from is None:
            return {}
        executed = self._executed(method.burden_from, number)
        while self._awaits and executed is None:
            time.sleep(POLL_S)
            executed = self._executed(method.burden_from, number)
        if executed is None:
            raise ParameterError(
                f"{method.name} is given the burden of {method.burden_from}, which has no "
                f"round {number} for seed {self._episodes.run_seed} yet; run {method.burden_from} "
                "first"
            )
        return method.burden(executed)

    def _executed(self, method: str, number: int) -> tuple[EpisodeRecord, ...] | None:
        """What was executed in a round; None where it is not there yet."""
        path = round_path(self._directory, self._episodes.run_seed, method, number, "json")
        if path.exists():
            return read_result(path).executed
        count = self._episodes.schedule.episodes
        infos = self._episodes.infos(Purpose.LEARNING, method, number, count)
        names = [episode_name(info) for info in infos]
        if not self._awaits or not all(is_there(self._store.path, name) for name in names):
            return None
        return tuple(record_of(self._store.read(name, need_images=False)) for name in names)
