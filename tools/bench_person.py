"""What the gate asks of a person: a simulated one at the cockpit, against the script at once.

    python -m tools.bench_person [--quick] [--results DIRECTORY]

writes bench-person.json, which `sheath claims` reads. Each task is learned by its plan `quick`
(`runs/bench-person`, which a second call goes on from), and the last policy drives scenes that
nobody has learned from: once under its gate with the scripted expert, who answers at once and hands
back at once, and once as `sheath run --expert simulated-person` does, with the limits on requests
that hold for people and an operator who needs 1.2 s. A scene that the one saved and the other did
not is lost. Time is the robot's own: while it waits for him nothing moves, and no step is made.

Each task goes on for three minutes of the robot's time: in less of it three requests in any minute
could be more than four a minute in the mean. --quick takes one task and a part of it, to see that
it runs.
"""

import tempfile
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import count, islice
from pathlib import Path

from sheath_manip.cockpit.answered import AnsweredDriver
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.learning.checkpoint import digest
from sheath_manip.learning.drivers import GatedPolicy
from sheath_manip.learning.results import round_path
from sheath_manip.learning.run import LearningRun
from sheath_manip.rollout.asked import AskedInEpisode, asked_in, asked_in_all
from sheath_manip.rollout.request import Driver, EpisodeRequest
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.seeding import scene_seed
from sheath_manip.task import Task
from sheath_manip.tasks.table import STUDIES
from sheath_manip.types import EpisodeInfo, Outcome, Purpose, TaskSpec
from tools.bench import Line, at_least, at_most, run_bench

MOST_A_MINUTE = 4.0
LEAST_TURN_S = 1.0
METHOD = "sheath"
RUNS = Path("runs/bench-person")


@dataclass(frozen=True)
class Sizes:
    """How much is run."""

    tasks: tuple[str, ...] = ("platformer", "gauze-cutting", "grasp-clutter", "driving")
    minutes: float = 3.0
    """of the robot's time with the person, at least, of each task"""
    runs: Path | None = RUNS
    """where learning goes on from; None: nothing is kept"""


def people(sizes: Sizes) -> dict[str, Line]:
    """Return the lines of every task."""
    lines: dict[str, Line] = {}
    with tempfile.TemporaryDirectory() as folder:
        for name in sizes.tasks:
            lines |= _lines_of(name, sizes.minutes, (sizes.runs or Path(folder)) / name)
    return lines


def _lines_of(name: str, minutes: float, runs: Path) -> dict[str, Line]:
    study = STUDIES[name]
    plan = study.plan("quick").changed(
        comparison={"evaluation_episodes": 1, "final_episodes": 1, "methods": (METHOD,)}
    )
    with SerialExecutor() as executor:
        learning = LearningRun(
            study.task, plan, 0, runs, EpisodeStore.create(runs / "store"), executor
        )
        last = learning.run(METHOD)[-1].round
    path = round_path(runs, 0, METHOD, last, "npz")
    script = GatedPolicy(path, digest(path))
    variant = plan.schedule.variant
    coming = scenes(learning.spec, variant, script)
    answered = asked_of(study.task, coming, AnsweredDriver(script), minutes)
    same = islice(scenes(learning.spec, variant, script), len(answered))
    return lines_of(name, asked_of(study.task, same, script), answered)


def scenes(spec: TaskSpec, variant: str, driver: GatedPolicy) -> Iterator[EpisodeInfo]:
    """Yield scenes of a task that no round and no evaluation has, without end."""
    for index in count():
        yield EpisodeInfo.of(
            spec,
            variant=variant,
            seed=scene_seed(Purpose.LEARNING, "person", index),
            purpose=Purpose.LEARNING,
            method=METHOD,
            index=index,
            checkpoint=driver.digest,
        )


def asked_of(
    task: Task, infos: Iterable[EpisodeInfo], driver: Driver, minutes: float = float("inf")
) -> list[AskedInEpisode]:
    """Run scenes with `driver`, for so many minutes of the robot's time; what each asked."""
    found: list[AskedInEpisode] = []
    with SerialExecutor() as executor:
        for episode in executor.map(EpisodeRequest(task, info, driver) for info in infos):
            found.append(asked_in(episode))
            if sum(each.length_s for each in found) >= 60 * minutes:
                break
    return found


def lines_of(
    name: str, at_once: Sequence[AskedInEpisode], answered: Sequence[AskedInEpisode]
) -> dict[str, Line]:
    """Return a task's lines: how often he is asked, for how long, and what is lost by it."""
    script, person = asked_in_all(at_once), asked_in_all(answered)
    lost = sum(
        saved.outcome is Outcome.SUCCESS and other.outcome is not Outcome.SUCCESS
        for saved, other in zip(at_once, answered, strict=True)
    )
    minutes = sum(each.length_s for each in answered) / 60
    driven = person.driven_s / (60 * minutes)
    return {
        f"{name}: requests": at_most(
            person.requests_a_minute,
            MOST_A_MINUTE,
            "a minute",
            f"{person.requests} in {minutes:.1f} min, {person.requests_an_episode:.1f} an episode; "
            f"the script at once {script.requests_a_minute:.0f} a minute",
        ),
        f"{name}: median turn": at_least(
            person.median_turn_s,
            LEAST_TURN_S,
            "s",
            f"he drives {driven:.0%} of the time and is waited for {person.waited_s:.0f} s; the "
            f"script {script.median_turn_s:.2f} s",
        ),
        f"{name}: scenes that only he lost": at_most(
            lost,
            0,
            f"of {person.episodes}",
            f"{_saved(at_once)} saved by the script, {_saved(answered)} with him",
        ),
    }


def _saved(episodes: Sequence[AskedInEpisode]) -> int:
    return sum(each.outcome is Outcome.SUCCESS for each in episodes)


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print and write."""
    quick = Sizes(("platformer",), minutes=0.3, runs=None)
    run_bench("person", __doc__, [people], Sizes(), quick, arguments)


if __name__ == "__main__":
    main()
