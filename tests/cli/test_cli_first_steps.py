"""What the command says to those who do not know it yet."""

import os
import pty
import shlex
import subprocess
from pathlib import Path

import pytest
from rich.console import Console

from sheath_manip.cli.doctor import AFTER_CURE, NEXT, Finding, report
from sheath_manip.cli.entry import OF_A_STORE, VERBS, read_line
from sheath_manip.cli.examples import EXAMPLES, FIRST_STEPS
from tests.toy import CATALOG
from tests.waiting import DEADLINE_S

ROOT = Path(__file__).parents[2]


def test_without_arguments_it_says_what_to_do_first(sheath):
    assert sheath() == (0, FIRST_STEPS, "")
    lines = [line.strip() for line in FIRST_STEPS.splitlines()]
    for verb in ("collect", "train", "run", "replay"):
        assert EXAMPLES[verb] in lines


def test_every_verb_has_an_example(sheath):
    nested = {
        f"{verb} {name}"
        for verb in ("data", "gate")
        for name in sheath(verb, "--help")[1].split("{", 1)[1].split("}")[0].split(",")
    }
    assert set(EXAMPLES) == {*VERBS, *nested}
    assert "data" in OF_A_STORE


@pytest.mark.parametrize("verb", EXAMPLES)
def test_a_help_shows_its_example_which_the_command_takes(sheath, verb):
    code, out, _ = sheath(*verb.split(), "--help")
    assert code == 0
    assert f"Example: {EXAMPLES[verb]}" in out
    assert EXAMPLES[verb].startswith(f"sheath {verb}")
    assert read_line(VERBS, lambda: CATALOG, shlex.split(EXAMPLES[verb])[1:])


def test_the_list_of_verbs_gives_each_one_sentence(sheath):
    listed = sheath("--help")[1]
    assert "Record demonstrations that a person drives" in listed
    assert "An episode begins when the person takes over" not in listed
    assert "An episode begins when the person takes over" in sheath("teleop", "--help")[1]


@pytest.mark.parametrize(
    ("finding", "code", "advice"),
    [
        (Finding("gl", True, "well"), 0, NEXT),
        (Finding("gl", False, "ill", "cure it"), 1, AFTER_CURE),
    ],
)
def test_the_doctor_ends_with_what_to_run_next(capsys, monkeypatch, finding, code, advice):
    monkeypatch.setattr("sheath_manip.cli.doctor.examine", lambda: [finding])
    assert report(Console(width=200)) == code
    assert capsys.readouterr().out.splitlines()[-1] == f"next: {advice}"


@pytest.fixture
def demo(tmp_path) -> list[str]:
    """`make demo` with a command in the place of `sheath` that prints its options and ends."""
    for name in ("sheath", "python"):
        (tmp_path / name).write_text('#!/bin/sh\necho "called with $*"\n')
        (tmp_path / name).chmod(0o755)
    (tmp_path / "stamp").touch()
    here = (f"BIN={tmp_path}", f"RUNTIME_STAMP={tmp_path / 'stamp'}")
    return ["make", "--silent", "-C", str(ROOT), "-o", "gl", *here, "demo"]


def test_the_demo_ends_by_itself_without_a_terminal(demo):
    done = subprocess.run(demo, capture_output=True, text=True, timeout=DEADLINE_S, check=True)
    assert done.stdout.split()[2:] == ["experiment", "driving", "--quick", "--dashboard"]
    other = subprocess.run(
        [*demo, "PORT=0"], capture_output=True, text=True, timeout=DEADLINE_S, check=True
    )
    assert other.stdout.split()[-2:] == ["--port", "0"]


def test_at_a_terminal_the_demo_keeps_its_page_open_and_says_so(demo):
    reading, terminal = pty.openpty()
    subprocess.run(demo, stdout=terminal, timeout=DEADLINE_S, check=True)
    os.close(terminal)
    printed = os.read(reading, 10_000).decode()
    os.close(reading)
    assert "until Ctrl-C" in printed
    assert printed.split()[-1] == "--hold"
