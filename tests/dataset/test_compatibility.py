"""One check of all that is mixed: what differs is refused or named."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sheath_manip.dataset.card import card
from sheath_manip.dataset.check import check
from sheath_manip.dataset.compatibility import Alike, RecordedSpec, differences, remarks
from sheath_manip.dataset.exchange.exporting import export
from sheath_manip.dataset.exchange.selection import Selection
from sheath_manip.dataset.header import header_of
from sheath_manip.dataset.naming import episode_name, is_episode_name, split_session
from sheath_manip.dataset.sessions import begun, new_session
from sheath_manip.dataset.space import Space
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import StoreError
from sheath_manip.types import ActionSpec, EpisodeInfo, Purpose, TaskSpec
from tests.dataset.folders import unpacked
from tests.dataset.seals import unseal
from tests.episodes import INFO, episode_of
from tests.toy import Corridor
from tools.identical import identical

SPEC = TaskSpec(
    name="toy",
    control_rate_hz=10.0,
    action=ActionSpec(("push_n",), -np.ones(1, np.float32), np.ones(1, np.float32)),
    cameras={},
    feature_names=("x_m",),
    max_steps=10,
    metric="laps",
)
TASK = RecordedSpec.of_task(SPEC)
SPACE = Space.of(SPEC)


def other_space(**changes: object) -> RecordedSpec:
    return replace(TASK, space=replace(SPACE, **changes))


class TestDifferences:
    def test_a_recording_of_a_task_fits_it(self) -> None:
        assert differences(TASK, RecordedSpec.of(header_of(episode_of("pe"), SPACE))) == ()

    @pytest.mark.parametrize(
        ("other", "text"),
        [
            (replace(TASK, task="moon"), "task 'moon' instead of 'toy'"),
            (replace(TASK, control_rate_hz=24.0), "control rate 24 Hz instead of 10 Hz"),
            (replace(TASK, cameras={"top": (4, 6)}), "cameras top 4x6 instead of none"),
            (replace(TASK, feature_size=2, space=None), "number of features 2 instead of 1"),
            (replace(TASK, action_size=7, space=None), "number of actions 7 instead of 1"),
            (other_space(feature_names=("y_m",)), "features 'y_m' instead of 'x_m'"),
            (other_space(action_names=("push_kn",)), "actions 'push_kn' instead of 'push_n'"),
            (other_space(action_minimum=(-0.3,)), "lower bounds -0.3 instead of -1.0"),
            (other_space(action_maximum=(float("inf"),)), "upper bounds inf instead of 1.0"),
            (other_space(action_choices=((0.0,),)), "choices (0.0) instead of none"),
        ],
    )
    def test_each_is_named(self, other: RecordedSpec, text: str) -> None:
        assert list(map(str, differences(TASK, other))) == [text]

    def test_of_many_names_only_some_that_differ(self) -> None:
        names = tuple(f"tile_{number}" for number in range(600))
        wanted = replace(TASK, feature_size=600, space=replace(SPACE, feature_names=names))
        changed = replace(SPACE, feature_names=("a", *names[1:594], *"bcdefg"))
        (only,) = differences(wanted, replace(wanted, space=changed))
        assert only.got == "'a', 'b', 'c', 'd' and 3 more"

    def test_what_is_not_said_is_no_difference(self) -> None:
        assert differences(TASK, replace(TASK, space=None)) == ()
        assert differences(replace(TASK, space=None), TASK) == ()

    def test_but_does_not_hide_one_between_others(self) -> None:
        alike = Alike("split them")
        alike.take("old", replace(TASK, space=None))
        alike.take("first", TASK)
        with pytest.raises(StoreError, match=r"second does not fit first: features .*: split them"):
            alike.take("second", other_space(feature_names=("y_m",)))

    def test_variants_and_old_recordings_are_named(self) -> None:
        assert remarks([("easy", TASK), ("easy", TASK)]) == ()
        several, untold = remarks([("easy", TASK), ("", replace(TASK, space=None))])
        assert several == "episodes of several variants: 1 of 'easy', 1 of an unknown one"
        assert untold.startswith("1 of 2 episodes do not say what")


class TestSpace:
    @pytest.mark.parametrize("choices", [None, ((-1.0,), (float("-inf"),))])
    def test_it_comes_back_from_json(self, choices) -> None:
        space = replace(SPACE, action_choices=choices, action_maximum=(float("inf"),))
        text = json.dumps(space.to_json(), allow_nan=False)
        assert Space.from_json(json.loads(text)) == space

    def test_every_task_says_what_it_is(self, specs) -> None:
        for spec in specs.values():
            space = Space.of(spec)
            assert Space.from_json(json.loads(json.dumps(space.to_json()))) == space
            assert len(space.action_minimum) == len(space.action_names)

    def test_names_of_another_number_are_refused(self, store: EpisodeStore) -> None:
        two = replace(SPACE, feature_names=("x_m", "y_m"))
        with pytest.raises(StoreError, match="the names of 1 features, got 2"):
            store.append(episode_of("pe"), two)

    def test_it_is_kept_and_comes_back(self, store: EpisodeStore) -> None:
        info = replace(INFO, variant="easy", session="3f")
        header = store.header(store.append(episode_of("pe", info=info), SPACE))
        assert (header.info, header.space) == (info, SPACE)
        (summary,) = store.infos()
        assert summary.spec == TASK
        assert store.has(info)
        with pytest.raises(StoreError, match="variant 'easy' instead of 'hard'"):
            store.has(replace(info, variant="hard"))


def aged(store: EpisodeStore, name: str) -> None:
    """Write the header as before schema 2."""

    def change(attributes: dict[str, Any]) -> None:
        for key in ("variant", "session", "space"):
            del attributes[key]
        attributes["schema"] = 1

    unseal(unpacked(store, name), change)


class TestOldStores:
    @pytest.fixture
    def old(self, store: EpisodeStore) -> EpisodeStore:
        aged(store, store.append(episode_of("pe"), SPACE))
        return store

    def test_they_stay_readable(self, old: EpisodeStore) -> None:
        (name,) = old.names()
        header = old.header(name)
        assert (header.info.variant, header.info.session, header.space) == ("", "", None)
        info = replace(INFO, variant="")
        assert identical(old.read(name), episode_of("pe", info=info))
        assert check(old) == []
        assert "- variant: not recorded" in card(old, SPEC, "MIT")

    def test_a_run_goes_on_in_them(self, old: EpisodeStore) -> None:
        assert old.has(INFO)
        assert old.has(replace(INFO, variant="easy"))
        with pytest.raises(StoreError, match="another run: checkpoint '' instead of 'x'"):
            old.has(replace(INFO, checkpoint="x"))


class TestSessions:
    def test_a_name_says_of_which_it_is(self) -> None:
        info = replace(INFO, session="3fa9")
        name = episode_name(info)
        assert name == "learning-s0-r00-i000-seed7-session3fa9"
        assert is_episode_name(name)
        assert split_session(name) == (episode_name(INFO), "3fa9")
        assert split_session(episode_name(INFO)) == (episode_name(INFO), "")
        odd = episode_name(replace(INFO, method="a-s1-r00-i000-seed1-sessionx"))
        assert split_session(odd) == (odd, "")

    @pytest.mark.parametrize("session", ["a-b", "../x", "ä", " "])
    def test_it_is_a_word(self, store: EpisodeStore, session: str) -> None:
        with pytest.raises(StoreError, match="session of letters and digits"):
            store.append(episode_of("pe", info=replace(INFO, session=session)))

    def test_a_recording_goes_on_where_it_ended(self, store: EpisodeStore) -> None:
        wanted = [replace(INFO, index=index) for index in range(3)]
        first = begun(store, wanted[:2], new_session())
        for info in first:
            store.append(episode_of("pe", info=info))
        again = begun(store, wanted, "later")
        assert again == [*first, replace(wanted[2], session="later")]
        assert [store.has(info) for info in again] == [True, True, False]
        assert len({info.session for info in first}) == 1


def test_an_info_is_made_of_a_spec() -> None:
    spec = Corridor().spec
    info = EpisodeInfo.of(spec, variant="long", seed=3, purpose=Purpose.LEARNING, index=2)
    wanted = EpisodeInfo("corridor", 3, Purpose.LEARNING, 50.0, index=2, variant="long")
    assert info == wanted


class TestMixed:
    @pytest.fixture
    def mixed(self, store: EpisodeStore) -> EpisodeStore:
        """Episodes of 10 and of 24 Hz, of two variants."""
        for index, (rate_hz, variant) in enumerate([(10.0, "default"), (24.0, "easy")]):
            info = replace(INFO, index=index, control_rate_hz=rate_hz, variant=variant)
            store.append(episode_of("pe", info=info), SPACE)
        return store

    def test_a_card_names_both(self, mixed: EpisodeStore) -> None:
        lines = card(mixed, None, "MIT").splitlines()
        assert "- control rate: 1 10 Hz, 1 24 Hz" in lines
        assert "- variant: 1 default, 1 easy" in lines
        assert "- 1 episodes have another: control rate 24 Hz instead of 10 Hz" in lines
        (features,) = [line for line in lines if line.startswith("| `features`")]
        assert features.endswith(": `x_m` |")

    @pytest.mark.parametrize("form", ["replay-buffer", "robomimic", "minari"])
    def test_no_file_has_both(self, mixed: EpisodeStore, tmp_path: Path, form: str) -> None:
        with pytest.raises(StoreError, match="control rate 24 Hz instead of 10 Hz"):
            export(mixed, tmp_path / "out" / "x", form, Selection())
        assert not (tmp_path / "out" / "x").exists()

    def test_nothing_else_is_recorded_beside(self, mixed: EpisodeStore) -> None:
        mixed.require_fits(TASK, "the task")
        with pytest.raises(StoreError, match=r"the task does not fit .*: cameras .*of its own"):
            mixed.require_fits(replace(TASK, cameras={"top": (4, 4)}), "the task")
