"""The names of a store's episodes, and which directories open as a store."""

from dataclasses import replace
from pathlib import Path

import pytest

from sheath_manip.dataset.naming import episode_name, is_episode_name
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import StoreError
from tests.dataset.tiny_episodes import INFO, tiny


class TestNames:
    def test_a_name_says_where_the_episode_is_from(self) -> None:
        assert episode_name(INFO) == "learning-sheath-s0-r03-i007-seed12345"
        assert episode_name(replace(INFO, method="")) == "learning-s0-r03-i007-seed12345"

    @pytest.mark.parametrize("method", ["a/b", "../x", "β = 0.5", "a-s1-r00", "[red]"])
    def test_any_method_makes_a_plain_name(self, method: str) -> None:
        name = episode_name(replace(INFO, method=method))
        assert Path(name).name == name
        assert is_episode_name(name)

    @pytest.mark.parametrize("name", [".tmp-1", "notes", "learning", "playing-s0-r00-i000-seed1"])
    def test_other_entries_are_no_episodes(self, name: str) -> None:
        assert not is_episode_name(name)


class TestOpening:
    def test_create_makes_once_and_then_opens(self, tmp_path: Path) -> None:
        EpisodeStore.create(tmp_path / "a" / "b").append(tiny(INFO))
        assert len(EpisodeStore.create(tmp_path / "a" / "b").names()) == 1
        assert len(EpisodeStore(tmp_path / "a" / "b").names()) == 1

    def test_reading_wants_a_store(self, tmp_path: Path) -> None:
        with pytest.raises(StoreError, match="found nothing; give the directory"):
            EpisodeStore(tmp_path / "missing")
        assert not (tmp_path / "missing").exists()

    def test_a_foreign_directory_is_refused_and_left_alone(self, tmp_path: Path) -> None:
        (tmp_path / "thesis.tex").touch()
        for open_store in (EpisodeStore, EpisodeStore.create):
            with pytest.raises(
                StoreError, match=r"wanted an episode store at .*, found a directory"
            ):
                open_store(tmp_path)
        assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]

    def test_a_file_is_refused(self, tmp_path: Path) -> None:
        (tmp_path / "file").touch()
        with pytest.raises(StoreError, match="found a file"):
            EpisodeStore(tmp_path / "file")
        with pytest.raises(StoreError, match="choose a writable directory"):
            EpisodeStore.create(tmp_path / "file")

    @pytest.mark.parametrize(
        ("marker", "message"),
        [
            ('{"format": "sheath-store", "schema": 3}', "schema 3, wanted 1 or 2"),
            ('{"format": "other"}', "another format"),
            ("[]", "another format"),
            ("{", "does not decode"),
        ],
    )
    def test_another_marker_is_refused(
        self, store: EpisodeStore, marker: str, message: str
    ) -> None:
        (store.path / "sheath-store.json").write_text(marker)
        with pytest.raises(StoreError, match=message):
            EpisodeStore.create(store.path)

    def test_a_crash_while_making_the_store_is_no_obstacle(self, tmp_path: Path) -> None:
        (tmp_path / ".tmp-1").touch()
        assert EpisodeStore.create(tmp_path).names() == []
