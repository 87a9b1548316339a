"""What a store gives back: summaries, chosen episodes, labels, and what was limited."""

import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
import zarr
from zarr.storage import ZipStore

from sheath_manip.dataset.check import check
from sheath_manip.dataset.faults import FaultKind
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.places import archive_path
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import StoreError
from sheath_manip.types import Episode, Limited, Purpose, SignalScore
from tests.dataset.folders import unpacked
from tests.dataset.seals import unseal
from tests.dataset.tiny_episodes import INFO, tiny
from tools.identical import identical
from tools.synthetic import synthetic_episode, synthetic_info


class TestReading:
    def test_summaries(self, store: EpisodeStore, episode: Episode) -> None:
        name = store.append(episode)
        (summary,) = store.infos()
        by_expert = [step.decision.actor == "expert" for step in episode.steps]
        assert (summary.name, summary.info, summary.length) == (name, episode.info, 70)
        assert summary.expert_share == np.mean(by_expert)
        assert summary.queries == sum(by_expert)
        assert summary.metrics == episode.metrics
        assert summary.bytes > 0

    def test_episodes_are_chosen_and_in_order(self, store: EpisodeStore) -> None:
        for round in (100, 2):
            for index in (1, 0):
                store.append(tiny(replace(INFO, round=round, index=index)))
        store.append(tiny(replace(INFO, purpose=Purpose.EVALUATION)))
        store.append(tiny(replace(INFO, method="dagger", run_seed=1)))
        chosen = store.episodes(Purpose.LEARNING, "sheath", need_images=False)
        assert [(e.info.round, e.info.index) for e in chosen] == [
            (2, 0),
            (2, 1),
            (100, 0),
            (100, 1),
        ]
        assert [e.info.index for e in store.episodes(round=2)] == [0, 1]
        assert [e.info.method for e in store.episodes(run_seed=1)] == ["dagger"]
        assert len(list(store.read_many(store.names()))) == 6

    @pytest.mark.parametrize("name", ["../store", "notes", episode_name(INFO)])
    def test_a_missing_name_is_one_line(self, store: EpisodeStore, name: str) -> None:
        (store.path / "notes").mkdir()
        with pytest.raises(StoreError, match="has no episode"):
            store.read(name)

    def test_an_intervention_needs_a_policy(self, store: EpisodeStore, episode: Episode) -> None:
        demonstration = replace(
            episode,
            info=replace(episode.info, purpose=Purpose.DEMONSTRATION),
            steps=tuple(replace(step, proposed=None) for step in episode.steps),
        )
        by_expert = [step.decision.actor == "expert" for step in episode.steps]

        def interventions(recorded: Episode) -> list[bool]:
            group = zarr.open_group(zipped(store, store.append(recorded)), mode="r")
            array = group["intervention"]
            assert isinstance(array, zarr.Array)
            return np.asarray(array[:]).tolist()

        assert interventions(episode) == by_expert
        assert not any(interventions(demonstration))

    def test_a_reader_beside_a_writer_sees_whole_episodes_only(self, store: EpisodeStore) -> None:
        code = "import sys, pathlib, tools.kill_recorder as k; "
        code += "k.record_for_ever(pathlib.Path(sys.argv[1]), 0)"
        with subprocess.Popen(
            [sys.executable, "-c", code, str(store.path)], stdout=subprocess.DEVNULL
        ) as writer:
            try:
                seen: set[str] = set()
                while len(seen) < 5:
                    assert writer.poll() is None
                    for summary in store.infos():
                        if summary.name not in seen:
                            recorded = synthetic_episode(synthetic_info(0, summary.info.index))
                            assert identical(store.read(summary.name), recorded)
                            seen.add(summary.name)
            finally:
                writer.kill()
        assert not [fault for fault in check(store) if fault.damaging]


class TestSignals:
    def judged(self) -> Episode:
        episode = tiny(INFO)
        first, second = episode.steps
        scores = (SignalScore("precedent", -0.5, 0.02), SignalScore("support", 0.25, np.nan))
        judged = replace(first, decision=replace(first.decision, signals=scores))
        return replace(episode, steps=(judged, second))

    def test_what_a_score_is_made_of_is_kept(self, store: EpisodeStore) -> None:
        name = store.append(self.judged())
        assert zarr.open_array(zipped(store, name), path="signals", mode="r").shape == (2, 2, 2)
        assert identical(store.read(name), self.judged())
        assert store.read(name).columns.signals["precedent"][0].tolist() == [-0.5, 0.02]

    def test_an_episode_of_before_this_was_recorded_opens(self, store: EpisodeStore) -> None:
        name = store.append(tiny(INFO))
        assert "signals" not in zarr.open_group(zipped(store, name), mode="r")
        assert store.read(name).steps[0].decision.signals == ()
        assert check(store) == []


def test_threads_that_read_different_episodes_get_their_own(store: EpisodeStore) -> None:
    names = [store.append(tiny(replace(INFO, index=index))) for index in range(4)]
    switching_s = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)

    def told(name: str) -> bool:
        return all(episode_name(store.header(name).info) == name for _ in range(100))

    try:
        with ThreadPoolExecutor(len(names)) as threads:
            assert all(threads.map(told, names))
    finally:
        sys.setswitchinterval(switching_s)


def zipped(store: EpisodeStore, name: str) -> ZipStore:
    """As zarr opens it."""
    return ZipStore(archive_path(store.path, name), mode="r")


class TestLimits:
    def limited(self) -> Episode:
        episode = tiny(INFO)
        first, second = episode.steps
        changed = (Limited("joint velocity", 0.25), Limited("workspace", 1.5))
        return replace(episode, steps=(replace(first, limited=changed), second))

    def test_what_the_command_filter_changed_is_kept(self, store: EpisodeStore) -> None:
        name = store.append(self.limited())
        assert zarr.open_array(zipped(store, name), path="limited", mode="r").shape == (2, 2)
        first, second = store.read(name, need_images=False).steps
        assert first.limited == (Limited("joint velocity", 0.25), Limited("workspace", 1.5))
        assert second.limited == ()

    def test_an_episode_of_before_there_was_a_filter_opens(self, store: EpisodeStore) -> None:
        name = store.append(tiny(INFO))
        unseal(unpacked(store, name), lambda attributes: attributes.pop("limits"))
        assert not (store.path / name / "limited").exists()
        assert identical(store.read(name), tiny(INFO))
        assert check(store) == []

    def test_a_lost_array_of_limits_is_a_fault(self, store: EpisodeStore) -> None:
        name = store.append(self.limited())
        shutil.rmtree(unpacked(store, name) / "limited")
        assert [fault.kind for fault in check(store)] == [FaultKind.MISSING]
