"""How fast gauze is cut, how exactly, and how far its expert and two open loops come.

    python -m tools.bench_gauze [--quick] [--results DIRECTORY]

writes bench-gauze.json, which `sheath claims` reads. Times are of the CPU on one thread. --quick
takes other sizes, to see that it runs.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from sheath_manip.protocols import Expert
from sheath_manip.seeding import scene_seed
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.gauze_cutting.expert import GauzeExpert
from sheath_manip.tasks.gauze_cutting.scenario import CONTROL_TIMESTEP_S, Scenario
from sheath_manip.tasks.gauze_cutting.study.open_loops import blind, registered
from sheath_manip.tasks.gauze_cutting.task import GauzeTask
from sheath_manip.types import Action, Purpose
from tools.bench import Line, at_least, at_most, run_bench, spent_s

SEEDS = "bench-gauze"
"""of scenes that no experiment and no tuning has seen"""
EXACT_TOLERANCE = 1e-10
"""of MuJoCo's solver, to compare with"""
_STEPS_A_SECOND = round(1 / CONTROL_TIMESTEP_S)


@dataclass(frozen=True)
class Sizes:
    """How much is measured."""

    scenes: int = 100
    timed_scenes: int = 10
    exact_scenes: int = 5
    resets: int = 100


QUICK = Sizes(scenes=1, timed_scenes=1, exact_scenes=1, resets=5)


class Player:
    """An environment without cameras, and who acts in it."""

    def __init__(self, actor: Callable[[ComposerEnvironment], Expert] = GauzeExpert) -> None:
        self.task = GauzeTask(Scenario(cameras=()))
        self.environment = ComposerEnvironment(self.task)
        self.actor = actor(self.environment)

    def begin(self, number: int) -> None:
        """Reset to the scene of that number."""
        self.environment.reset(scene_seed(Purpose.EVALUATION, SEEDS, number))
        self.actor.reset()

    def play(self, steps: int = 10_000) -> list[Action]:
        """What was done in so many steps, or to the end."""
        actions, ended = [], False
        while len(actions) < steps and not ended:
            actions.append(self.actor.act(self.environment.observe()))
            transition = self.environment.step(actions[-1])
            ended = transition.terminated or transition.truncated
        return actions

    def repeat(self, actions: Sequence[Action]) -> None:
        """The same again, without asking."""
        for action in actions:
            self.environment.step(action)

    @property
    def warnings(self) -> int:
        """That MuJoCo has given since the episode began."""
        return sum(int(each.number) for each in self.environment.physics.data.ptr.warning)


@dataclass
class Played:
    """The episodes of one actor."""

    metrics: list[dict[str, float]] = field(default_factory=list)
    warnings: int = 0

    def column(self, name: str) -> np.ndarray:
        """(n,) of a metric."""
        return np.array([each[name] for each in self.metrics])


def played(actor: Callable[[ComposerEnvironment], Expert], scenes: int) -> Played:
    """All scenes by one actor."""
    player, found = Player(actor), Played()
    for number in range(scenes):
        player.begin(number)
        player.play()
        found.metrics.append(dict(player.environment.metrics()))
        found.warnings += player.warnings
    return found


def speed_lines(sizes: Sizes) -> dict[str, Line]:
    """A whole episode of cutting, arm included, without rendering."""
    player, factors = Player(), []
    for number in range(sizes.timed_scenes):
        player.begin(number)
        actions = player.play()
        player.begin(number)
        spent = spent_s(lambda actions=actions: player.repeat(actions))
        factors.append(len(actions) * CONTROL_TIMESTEP_S / spent)
    how = f"an expert's actions again, arm and cutting included, median of {len(factors)} episodes"
    reset = [spent_s(lambda n=n: player.begin(n)) for n in range(sizes.resets)]
    restore = spent_s(player.task.workpiece.make_whole, sizes.resets)
    return {
        "speed of cutting": at_least(float(np.median(factors)), 1.8, "times real time", how),
        "restoring the sheet": at_most(1e3 * restore, 5, "ms", f"mean of {sizes.resets}"),
        "reset, all of it": at_most(
            1e3 * float(np.median(reset)), 15, "ms", f"a new scene, median of {len(reset)}"
        ),
    }


def accuracy_lines(sizes: Sizes) -> dict[str, Line]:
    """How far a second of cutting ends from where an exact solve has it end."""
    player, apart = Player(), []
    for number in range(sizes.exact_scenes):
        for seconds in (2, 5):
            player.begin(number)
            model = player.environment.physics.model.ptr
            tolerance = model.opt.tolerance
            player.play(seconds * _STEPS_A_SECOND)
            state = player.environment.state()
            actions = player.play(_STEPS_A_SECOND)
            ends = []
            for each in (tolerance, EXACT_TOLERANCE):
                model.opt.tolerance = each
                player.environment.restore(state)
                player.repeat(actions)
                sheet = player.task.workpiece.sheet
                ends.append(player.task.workpiece.lie().positions_m[: sheet.spares.start])
            model.opt.tolerance = tolerance
            apart.append(float(np.linalg.norm(ends[0] - ends[1], axis=1).max()))
    how = (
        f"the vertex farthest from a solve to {EXACT_TOLERANCE:g}, worst of {len(apart)} seconds; "
        f"median {1e3 * float(np.median(apart)):.4f}"
    )
    return {"error of a second": at_most(1e3 * max(apart), 0.05, "mm", how)}


def expert_lines(sizes: Sizes) -> dict[str, Line]:
    """The expert on scenes that nobody has seen."""
    found = played(GauzeExpert, sizes.scenes)
    iou, freed = found.column("iou"), found.column("freed")
    deviation = found.column("deviation_mm")
    how = f"{int(freed.sum())} of {len(freed)} discs"
    return {
        "expert's share freed": at_least(float(freed.mean()), 0.95, "of discs", how),
        "expert's IoU": at_least(
            float(iou.mean()), 0.975, "mean", f"smallest {iou.min():.4f}, {len(iou)} episodes"
        ),
        "expert's deviation": at_most(
            float(deviation.mean()), 0.2, "mm", f"mean of means; largest {deviation.max():.3f}"
        ),
        "expert's stray pieces": at_most(found.column("stray_pieces").sum(), 0, "pieces", how),
        "MuJoCo's warnings": at_most(found.warnings, 0, "warnings", how),
    }


def open_loop_lines(sizes: Sizes) -> dict[str, Line]:
    """Who does not look, on the same scenes."""
    lines = {}
    for name, actor in (("registered", registered), ("blind", blind)):
        found = played(actor, sizes.scenes)
        iou, freed = found.column("iou"), found.column("freed")
        how = (
            f"{int(freed.sum())} of {len(freed)} discs, IoU of those "
            f"{iou[freed > 0].mean() if freed.any() else 0.0:.3f}, deviation "
            f"{found.column('deviation_mm').mean():.2f} mm; a stray cut ends the others"
        )
        lines[f"{name} open loop's share freed"] = at_most(
            float(freed.mean()), 0.5, "of discs", how
        )
    return lines


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print a line a number, write the file."""
    measures = speed_lines, accuracy_lines, expert_lines, open_loop_lines
    run_bench("gauze", __doc__, measures, Sizes(), QUICK, arguments)


if __name__ == "__main__":
    main()
