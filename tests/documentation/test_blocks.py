"""Every shell line and every Python block of README and docs is run, or stands on a short list."""

import shlex
import sys
import tomllib
from functools import cache
from types import ModuleType

import pytest

from sheath_manip.cli.benchmarks import BENCHMARKS
from sheath_manip.cli.entry import VERBS, read_line
from sheath_manip.cli.examples import EXAMPLES
from tests.documentation.blocks import (
    FILES_NOT_RUN,
    NOT_RUN,
    PAGES,
    ROOT,
    blocks,
    calls_in_prose,
    reason_not_to_run,
    run_python,
    run_shell,
    shell_lines,
    shows_a_file,
)
from tests.toy import CATALOG
from tools.docs.commands import help_of

LANGUAGES = {"sh", "python", "toml", "text", "{toctree}", "{eval-rst}"}
AFTER_SHELL = {"docs/quick-start.md", "docs/own/data.md", "docs/own/frozen-policy.md"}
"""pages whose Python reads what their shell lines made"""
ALL = [block for page in PAGES for block in blocks(page)]
WITH_PYTHON = sorted({block.page for block in ALL if block.language == "python"})
RUN = sorted({block.page for block in ALL if block.language in ("sh", "python")})


def test_every_block_names_a_language_that_is_known_here():
    unknown = [f"{b.page}:{b.line} {b.language!r}" for b in ALL if b.language not in LANGUAGES]
    assert not unknown


def test_the_command_takes_every_line_that_calls_it():
    lines = [line for block in ALL if block.language == "sh" for line in shell_lines(block)]
    # A file that a page shows, and which wants what is not here.
    lines = [line.replace("fetch.py:FETCH", "examples/own_task.py:CART") for line in lines]
    calls = [shlex.split(line)[1:] for line in lines if line.startswith("sheath ")]
    assert len(calls) > 20
    for argv in calls:
        assert read_line(VERBS, lambda: CATALOG, argv), argv


def test_a_sentence_names_verbs_and_options_that_there_are():
    named = {call for page in PAGES for call in calls_in_prose(page)}
    assert len(named) > 20
    help_for = cache(help_of)
    for call in named - {"sheath --help"}:
        _, verb, *rest = call.split()
        if verb in ("data", "gate") and rest[:1] and rest[0].islower():
            verb += f" {rest.pop(0)}"
        if verb in ("VERB", "…"):
            continue
        assert verb in EXAMPLES, call
        if verb == "experiment" and rest[:1] and rest[0] in BENCHMARKS:
            verb += f" {rest.pop(0)}"
        for option in rest:
            if option.startswith("--"):
                assert f"{option} " in help_for(verb).replace("\n", " "), call


def test_toml_blocks_are_toml():
    tables = [tomllib.loads(block.text) for block in ALL if block.language == "toml"]
    assert tables
    assert all("entry-points" in table["project"] for table in tables)


def test_the_list_of_what_is_not_run_is_short_and_holds_nothing_in_vain():
    lines = [line for block in ALL if block.language == "sh" for line in shell_lines(block)]
    used = {reason_not_to_run(line) for line in lines} - {None}
    assert used == set(NOT_RUN.values())
    assert len(NOT_RUN) < 12


@pytest.mark.parametrize("page", [page for page in WITH_PYTHON if page not in AFTER_SHELL])
def test_python_runs_as_it_stands(page, monkeypatch, tmp_path):
    names = _module(monkeypatch, tmp_path)
    for block in blocks(page):
        if block.language == "python" and not shows_a_file(block):
            run_python(block, names)


def test_a_file_that_is_not_run_is_shown_as_it_is():
    for page, lines in FILES_NOT_RUN.items():
        assert sum(map(shows_a_file, blocks(page))) == len(lines)


@pytest.mark.soak
@pytest.mark.parametrize("page", RUN)
def test_a_page_runs_from_its_first_line_to_its_last(page, monkeypatch, tmp_path):
    names = _module(monkeypatch, tmp_path)
    for folder in ("results", "examples"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    # As a program of a reader's own finds the files beside it.
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "mine", raising=False)
    for block in blocks(page):
        if block.language == "sh":
            run_shell(block, tmp_path)
        elif block.language == "python" and not shows_a_file(block):
            run_python(block, names)


def _module(monkeypatch, place):
    """The names of a module that runs in `place`, and can import a package of somebody else."""
    monkeypatch.chdir(place)
    monkeypatch.syspath_prepend(ROOT / "tests" / "guest_package")
    module = ModuleType("page")
    monkeypatch.setitem(sys.modules, "page", module)
    return vars(module)
