import json
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from sheath_manip.dataset.check import check
from sheath_manip.dataset.exchange.selection import ActionChoice, Selection, selected
from sheath_manip.dataset.faults import FaultKind
from sheath_manip.dataset.mapped import mapped_samples
from sheath_manip.dataset.marks import LONGEST_NOTE, Marks, Note, parse_marks
from sheath_manip.dataset.merging import merge
from sheath_manip.dataset.show import print_show
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, StoreError
from sheath_manip.types import Outcome
from sheath_manip.types.samples import samples_from
from tests.dataset.tiny_episodes import entries
from tests.episodes import INFO, episode_of
from tools.identical import identical


def test_stretches_join_and_refuse_what_is_none() -> None:
    marks = Marks().with_bad(5, 8).with_bad(1, 2).with_bad(2, 4).with_bad(7, 9)
    assert marks.bad == ((1, 4), (5, 9))
    assert marks.is_bad(6).tolist() == [False, True, True, True, False, True]
    for start, stop in ((3, 3), (-1, 2), (4, 2)):
        with pytest.raises(ParameterError, match="bad stretch"):
            Marks().with_bad(start, stop)


def test_marks_lie_beside_an_episode_that_stays(store: EpisodeStore) -> None:
    name = store.append(episode_of("peepp", "xxxxx"))
    before, files = store.read(name), dict(store.files(name))
    assert store.marks(name) == Marks()
    marks = Marks(Outcome.FAILURE, ((1, 3),))
    store.mark(name, marks)
    assert store.marks(name) == marks
    assert dict(store.files(name)) == files
    assert identical(store.read(name), before)
    assert store.names() == [name]
    assert check(store) == []
    summary = store.summary(name)
    assert (summary.outcome, summary.recorded_outcome) == (Outcome.FAILURE, Outcome.SUCCESS)
    assert summary.bad_steps == 2
    store.mark(name, Marks())
    assert [entry.name for entry in store.path.glob("*.marks.json")] == []


def test_a_note_of_a_step_is_kept_and_can_be_taken_away(store: EpisodeStore) -> None:
    name = store.append(episode_of("peepp"))
    marks = Marks().with_note(3, " slips\x1b[2J\n here ").with_note(1, "touches")
    assert marks.notes == (Note(1, "touches"), Note(3, "slips\\x1b[2J here"))
    store.mark(name, marks)
    assert store.marks(name) == marks
    assert check(store) == []
    assert marks.with_note(1, " ").notes == marks.notes[1:]
    assert marks.with_note(3, "holds").notes[1] == Note(3, "holds")
    for step, text in ((-1, "before"), (0, "x" * (LONGEST_NOTE + 1))):
        with pytest.raises(ParameterError, match="the note has"):
            Marks().with_note(step, text)


@pytest.mark.parametrize("notes", [[[1, ""]], [[2, "a"], [1, "b"]], [[1, "a\n"]], [[-1, "a"]], [1]])
def test_notes_that_are_none_are_a_fault(notes: list) -> None:
    text = json.dumps(
        {"format": "sheath-marks", "schema": 1, "outcome": None, "bad": [], "notes": notes}
    )
    with pytest.raises(StoreError, match="no marks"):
        parse_marks("a file", text.encode())


def test_marks_beyond_the_episode_are_refused(store: EpisodeStore) -> None:
    name = store.append(episode_of("pe"))
    with pytest.raises(StoreError, match="2 steps"):
        store.mark(name, Marks(bad=((1, 3),)))
    assert store.marks(name) == Marks()


def test_what_is_bad_is_neither_learned_nor_exported(store: EpisodeStore, tmp_path: Path) -> None:
    good = store.append(episode_of("eeee"))
    name = store.append(episode_of("eeeee", info=replace(INFO, index=1)))
    store.mark(name, Marks(bad=((1, 3),)))
    names = [good, name]
    assert len(samples_from(store.learnable(names))) == 7
    assert len(mapped_samples(store, names, tmp_path / "cache")) == 7
    lengths = [recorded.header.length for recorded in selected(store, Selection())]
    assert lengths == [4, 1, 2]
    labelled = Selection(action=ActionChoice.LABELLED, bad_steps=True)
    assert [recorded.header.length for recorded in selected(store, labelled)] == [4, 5]
    # Marked anew, the files of the mapped samples are others, too.
    store.mark(name, Marks())
    assert len(mapped_samples(store, names, tmp_path / "cache")) == 9


def test_the_marked_outcome_selects(store: EpisodeStore) -> None:
    name = store.append(episode_of("pe", outcome=Outcome.FAILURE))
    with pytest.raises(StoreError, match="nothing is selected"):
        list(selected(store, Selection(successes=True)))
    store.mark(name, Marks(outcome=Outcome.SUCCESS))
    (recorded,) = selected(store, Selection(successes=True))
    assert recorded.header.outcome is Outcome.SUCCESS


def test_marks_go_where_the_episode_goes(store: EpisodeStore, tmp_path: Path) -> None:
    name = store.append(episode_of("pe"))
    marks = Marks(Outcome.FAILURE, ((0, 1),))
    store.mark(name, marks)
    other = EpisodeStore.create(tmp_path / "other")
    merge([store], other)
    assert other.marks(name) == marks
    other.drop(name)
    assert entries(other) == ["sheath-store.json"]


def test_show_tells_of_marks(store: EpisodeStore) -> None:
    name = store.append(episode_of("peep"))
    store.mark(name, Marks(Outcome.FAILURE, ((1, 3),)))
    console = Console(width=160)
    with console.capture() as captured:
        print_show(str(store.path), name, console)
    text = captured.get()
    assert "marked as" in text
    assert "failure" in text
    assert "1 .. 2" in text


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"{",
        b"[]",
        b'{"format": "other"}',
        json.dumps({"format": "sheath-marks", "schema": 2}).encode(),
        json.dumps({"format": "sheath-marks", "schema": 1, "outcome": "won", "bad": []}).encode(),
        json.dumps(
            {"format": "sheath-marks", "schema": 1, "outcome": None, "bad": [[3, 1]]}
        ).encode(),
    ],
)
def test_broken_marks_are_one_line_and_a_fault(store: EpisodeStore, content: bytes) -> None:
    name = store.append(episode_of("pe"))
    (store.path / f"{name}.marks.json").write_bytes(content)
    with pytest.raises(StoreError, match="mark the episode again"):
        store.marks(name)
    (fault,) = check(store)
    assert fault.kind is FaultKind.UNREADABLE
    assert fault.damaging
    # The episode itself is whole.
    assert len(store.read(name)) == 2


def test_marks_without_an_episode_are_a_fault(store: EpisodeStore) -> None:
    name = store.append(episode_of("pe"))
    store.mark(name, Marks(outcome=Outcome.FAILURE))
    other = name.replace("i000", "i001")
    (store.path / f"{name}.marks.json").rename(store.path / f"{other}.marks.json")
    (fault,) = check(store)
    assert fault.kind is FaultKind.FOREIGN
