"""What breaks down under the command line is one line, and what was recorded is there."""

from dataclasses import replace

import pytest

from sheath_manip.cli.entry import run_command
from sheath_manip.cli.session import Catalog
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.task import Task
from sheath_manip.types import Breakdown, Outcome
from tests.toy import CORRIDOR, Corridor, MiddleKeeper


class LastingKeeper(MiddleKeeper):
    """Keeps to the middle in the first episode, and breaks down in the second."""

    episodes = 0

    def reset(self) -> None:
        self.episodes += 1
        self.steps = 0

    def act(self, observation):
        self.steps += 1
        if self.episodes == 2 and self.steps == 4:
            raise ValueError("the planner found\nno way \x1b[31mout")
        return super().act(observation)


def collect(task: Task, path, *options: object) -> int:
    argv = ["collect", "corridor", "--store", path, "--episodes", 3, *options]
    return run_command(lambda: Catalog({"corridor": task}, {}), [str(word) for word in argv])


@pytest.mark.parametrize("workers", [0, 1])
def test_an_expert_that_breaks_down_costs_its_attempt_a_name_and_nothing_else(
    workers, tmp_path, capfd
):
    path = tmp_path / "store"
    assert collect(replace(CORRIDOR, expert=LastingKeeper), path, "--workers", workers) == 2
    err = [line for line in capfd.readouterr().err.splitlines() if line.strip()]
    assert len([line for line in err if line.startswith("sheath: ")]) == 1, err
    said = err[-1]
    assert "the expert broke down (ValueError: the planner found no way ?[31mout)" in said
    assert "Traceback" not in "".join(err)
    store = EpisodeStore(path)
    outcomes = {name: store.read(name).outcome for name in store.names()}
    cut_short = [name for name, outcome in outcomes.items() if outcome is Outcome.ERROR]
    assert len(cut_short) == 1
    kept = store.read(cut_short[0])
    assert kept.cut_short_by == Breakdown("expert", "ValueError")
    assert len(kept) > 3
    # It bars nobody from the episode itself, and counts for none.
    assert collect(CORRIDOR, path) == 0
    assert len(store.names()) == 4
    assert len(list(store.episodes())) == 3


class Unmakeable:
    """An environment that cannot be made twice: the first is for the command to look at."""

    made = 0

    def __new__(cls):
        cls.made += 1
        if cls.made > 1:
            raise KeyError("no such body: table")
        return Corridor()


def test_an_environment_that_cannot_be_made_is_a_line(tmp_path, capsys):
    Unmakeable.made = 0
    assert collect(replace(CORRIDOR, variants={"default": Unmakeable}), tmp_path / "store") == 2
    assert "the environment could not be made (KeyError" in capsys.readouterr().err


class Unclosable(Corridor):
    def close(self) -> None:
        raise OSError("the robot's line is dead")


def test_an_environment_that_cannot_be_closed_loses_nothing(tmp_path):
    closing = replace(CORRIDOR, variants={"default": Late})
    Late.made = 0
    assert collect(closing, tmp_path / "store") == 0
    assert len(EpisodeStore(tmp_path / "store").names()) == 3


class Late:
    """Closes as it should where the command looks at it, not where it was run."""

    made = 0

    def __new__(cls):
        cls.made += 1
        return Corridor() if cls.made == 1 else Unclosable()
