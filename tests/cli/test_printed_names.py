"""Names out of files that others wrote move no cursor and set no title of a terminal."""

from dataclasses import replace

import pytest
from rich.text import Text

from sheath_manip.cli.plain_console import PlainConsole
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.printable import printable
from tests.episodes import INFO, episode_of

TITLE = "\x1b]0;mine\x07"


@pytest.fixture
def store(tmp_path):
    store = EpisodeStore.create(tmp_path / "store")
    info = replace(INFO, task=TITLE, method=TITLE, variant=TITLE)
    store.append(episode_of("pe", info=info, metrics={TITLE: 1.0}))
    (store.path / f"notes{TITLE}\n").touch()
    return store.path


@pytest.mark.parametrize("words", [("list",), ("show", "--episode", "0"), ("check",)])
def test_a_table_has_them_written_out(sheath, store, words) -> None:
    verb, *options = words
    _, out, err = sheath("data", verb, store, *options)
    assert "\x1b" not in out + err
    assert "\x07" not in out + err
    assert "\\x1b" in out


def test_a_card_has(sheath, store) -> None:
    _, out, _ = sheath("data", "list", store, "--card", "--licence", TITLE)
    assert "\\x1b]0;mine" in out
    assert "\x1b" not in out


def test_an_error_has(complaint, store) -> None:
    line = complaint("data", "show", store, "--episode", TITLE)
    assert "\x1b" not in line
    assert "\\x1b]0;mine" in line


def test_what_can_be_seen_stays(capsys) -> None:
    assert printable("a\nβ·é 漢") == "a\nβ·é 漢"
    assert printable("\x9b2J\u202e") == "\\x9b2J\\u202e"
    PlainConsole(width=20).print(Text("wide\x1b[2J"))
    assert capsys.readouterr().out == "wide\\x1b[2J\n"
