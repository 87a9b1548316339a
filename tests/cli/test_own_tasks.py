"""A task by its file, `file.py:TASK`, in the verbs that take one."""

import sys
from pathlib import Path

import pytest

from sheath_manip.dataset.store import EpisodeStore
from tests.cli.test_cli_bad_input import REST, VERBS

EXAMPLE = Path(__file__).parents[2] / "examples" / "own_task.py"
OTHERS = """
from tests.toy import CORRIDOR, PLAN, Study

NUMBER = 3
SHORT = Study(CORRIDOR, plans={"full": PLAN.changed(schedule={"rounds": 7})})
"""


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A directory for files with tasks, of which nothing is left behind."""
    before = set(sys.modules)
    monkeypatch.setattr(sys, "path", list(sys.path))
    monkeypatch.chdir(tmp_path)
    yield tmp_path
    for name in set(sys.modules) - before:
        if Path(getattr(sys.modules[name], "__file__", None) or "").parent == tmp_path:
            del sys.modules[name]


@pytest.fixture
def others(place) -> Path:
    (place / "others.py").write_text(OTHERS)
    return place / "others.py"


def test_workers_run_it_and_a_replay_is_told_its_file(sheath, complaint, place):
    store, task = place / "store", f"{EXAMPLE}:CART"
    argv = ("collect", task, "--store", store, "--episodes", 2, "--workers", 1)
    code, out, _ = sheath(*argv)
    assert code == 0
    assert "2 succeeded, 0 failed, 0 stuck" in out
    # A recording says the name alone: what lies in somebody's store is never run as code.
    assert {each.info.task for each in EpisodeStore(store).infos()} == {"cart"}
    replay = ("replay", store, "--export", place / "film.mp4")
    line = complaint(*replay)
    assert "unknown task 'cart'" in line
    assert "--task file.py:TASK" in line
    assert sheath(*replay, "--task", task)[0] == 0
    assert (place / "film.mp4").stat().st_size > 1000


@pytest.mark.usefixtures("place")
def test_replay_wants_the_task_that_was_recorded(complaint, made):
    line = complaint("replay", made / "store", "--task", f"{EXAMPLE}:CART")
    assert "is the task 'cart'; the episode is of 'corridor'" in line


def test_a_checkpoint_runs_on_the_task_of_a_file_with_its_name(sheath, made, others):
    options = ("--checkpoint", made / "first.npz", "--episodes", 1)
    for name in (f"{others}:CORRIDOR", "tests.toy:CORRIDOR", "others.py:SHORT"):
        assert sheath("run", name, *options)[0] == 0
    assert sheath("evaluate", "others.py:CORRIDOR", *options)[0] == 0


def test_a_study_in_a_file_gives_the_defaults(sheath, others, monkeypatch):
    # So narrow that all options stand below one another.
    monkeypatch.setenv("COLUMNS", "80")
    for name, rounds in ((f"{others}:SHORT", 7), (f"{others}:CORRIDOR", 8)):
        _, out, _ = sheath("learn", name, "--help")
        words = out[out.index("--rounds") : out.index("--episodes", out.index("--rounds"))].split()
        assert f"(default: {rounds})" in " ".join(word for word in words if word != "│")


@pytest.mark.parametrize("verb", VERBS)
def test_each_verb_says_in_a_line_what_is_wrong(complaint, others, verb):
    def said(task: str) -> str:
        return complaint(verb, task, *REST[verb])

    assert "there is no file none.py" in said("none.py:CART")
    assert "'SHORTS'; known: CORRIDOR, SHORT; did you mean SHORT?" in said("others.py:SHORTS")
    assert "others.py:NUMBER is of type int; wanted a Task" in said("others.py:NUMBER")
    assert "does not say which task of the file; wanted others.py:CORRIDOR" in said("others.py")
    assert [path.name for path in others.parent.iterdir() if path.suffix] == ["others.py"]


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("broken.py", "x = 1\nassert x > 1, 'too\\nsmall'", "AssertionError in line 2: too small"),
        ("ends.py", "import sys\nsys.exit(3)", "cannot be imported (SystemExit in line 2: 3)"),
        ("torn.py", "x = (", "SyntaxError: '(' was never closed (torn.py, line 1)"),
        ("empty.py", "", "empty.py holds no Task; wanted one in it"),
        ("types.py", "", "types.py has the name of another module"),
        ("own-task.py", "", "own-task.py cannot be imported by its name"),
    ],
)
def test_a_file_that_cannot_be_used(complaint, place, name, content, said):
    (place / name).write_text(content)
    assert said in complaint("collect", f"{name}:TASK", "--store", place / "store")
    assert not (place / "store").exists()


def test_a_module_that_is_not_there(complaint, place):
    line = complaint("collect", "no.such:TASK", "--store", place / "store")
    assert "no.such cannot be imported (ModuleNotFoundError: No module named 'no')" in line
