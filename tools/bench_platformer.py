"""How fast the platformer steps, lays stages and plans, and how far its expert comes.

    python -m tools.bench_platformer [--quick] [--results DIRECTORY]

writes bench-platformer.json, which `sheath claims` reads. Times are of the CPU on one thread. Only
of the workers it is the wall's: nothing else should run beside them. --quick takes other sizes, to
see that it runs.
"""

import multiprocessing
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

import numpy as np

from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.platformer.expert import PlatformerExpert
from sheath_manip.tasks.platformer.planner import Planner
from sheath_manip.tasks.platformer.stage import LENGTH_TILES
from sheath_manip.tasks.platformer.task import PlatformerTask, Scenario
from sheath_manip.types import Action
from tools.bench import Line, at_least, at_most, run_bench, spent_s

FIRST_SEED = 50_000
"""of stages that no experiment and no tuning has seen"""


@dataclass(frozen=True)
class Sizes:
    """How much is measured."""

    stages: int = 100
    harder_stages: int = 30
    new_stages: int = 500
    worker_rounds: int = 5
    worker_episodes: int = 12


QUICK = Sizes(stages=2, harder_stages=1, new_stages=20, worker_rounds=1, worker_episodes=1)


class Player:
    """An environment with its expert."""

    def __init__(self, difficulty: int = 1) -> None:
        self.task = PlatformerTask(Scenario(difficulty))
        self.environment = ComposerEnvironment(self.task)
        self.expert = PlatformerExpert(self.environment)

    def play(self, seed: int) -> list[Action]:
        """What the expert did on the stage of `seed`."""
        observation, actions, ended = self.environment.reset(seed), [], False
        self.expert.reset()
        while not ended:
            actions.append(self.expert.act(observation))
            transition = self.environment.step(actions[-1])
            observation = transition.observation
            ended = transition.terminated or transition.truncated
        return actions

    def repeat(self, actions: Sequence[Action]) -> None:
        """The same again without the expert."""
        for action in actions:
            self.environment.step(action)


def expert_lines(sizes: Sizes) -> dict[str, Line]:
    """How far the expert comes, by difficulty."""
    lines = {}
    # The learning experiments are of difficulty 1; the harder ones leave room above it.
    for difficulty, stages, least in (
        (1, sizes.stages, 0.97),
        (2, sizes.harder_stages, 0.9),
        (3, sizes.harder_stages, 0.8),
    ):
        player, progress, spent = Player(difficulty), [], []
        for seed in range(FIRST_SEED, FIRST_SEED + stages):
            spent.append(spent_s(lambda seed=seed, player=player: player.play(seed)))
            progress.append(player.environment.metrics()["progress"])
        player.environment.close()
        done = int(np.sum(np.array(progress) >= 1))
        how = f"{done} of {stages} stages completed, {np.mean(spent):.2f} CPU s an episode"
        lines[f"expert's distance, difficulty {difficulty}"] = at_least(
            float(np.mean(progress)), least, f"of {LENGTH_TILES} tiles", how
        )
    return lines


def plan_lines(sizes: Sizes) -> dict[str, Line]:
    """A plan, from where the expert makes one and from every other state of its episodes."""
    player, planner, spent = Player(), Planner(), []
    for seed in range(FIRST_SEED, FIRST_SEED + sizes.harder_stages):
        actions = player.play(seed)
        player.environment.reset(seed)
        planner.begin(player.task.stage)
        for action in actions:
            moment = player.task.moment
            spent.append(spent_s(lambda moment=moment: planner.plan(moment)))
            player.environment.step(action)
    player.environment.close()
    median, p95 = 1e3 * np.percentile(spent, [50, 95])
    how = f"at each of the {len(spent)} states of {sizes.harder_stages} expert episodes"
    return {
        "plan, median": at_most(median, 25, "ms", how),
        "plan, 95th percentile": at_most(p95, 25, "ms", how),
    }


def step_lines(sizes: Sizes) -> dict[str, Line]:
    """A control step with its features, and a new stage."""
    player, spent = Player(), []
    for seed in range(FIRST_SEED, FIRST_SEED + sizes.harder_stages):
        actions = player.play(seed)
        player.environment.reset(seed)
        spent.append(spent_s(lambda actions=actions: player.repeat(actions)) / len(actions))
    how = f"ComposerEnvironment.step, the expert's actions again, {len(spent)} episodes"
    step = at_most(1e6 * np.median(spent), 250, "µs", how)
    random_state, physics = np.random.RandomState(0), player.environment.physics
    laid = [
        spent_s(lambda: player.task.initialize_episode(physics, random_state))
        for _ in range(sizes.new_stages)
    ]
    reset = [
        spent_s(lambda seed=seed: player.environment.reset(seed))
        for seed in range(sizes.new_stages)
    ]
    player.environment.close()
    how = f"the task's part of a reset, all of which is {1e3 * np.median(reset):.2f} ms"
    return {
        "control step with features": step,
        "new stage": at_most(1e3 * np.median(laid), 1, "ms", how),
    }


_player: list[Player] = []
"""in a worker process: its own, made by its first episode"""


def play_one(seed: int) -> None:
    """An expert episode in a worker process."""
    if not _player:
        _player.append(Player())
    _player[0].play(seed)


def worker_lines(sizes: Sizes) -> dict[str, Line]:
    """Two worker processes against one, in turns."""
    spawn = multiprocessing.get_context("spawn")
    rates: list[list[float]] = [[], []]
    pools = [ProcessPoolExecutor(workers, mp_context=spawn) for workers in (1, 2)]
    try:
        for pool in pools:
            # Long enough that each worker has made its own player before the clock starts.
            list(pool.map(play_one, range(FIRST_SEED, FIRST_SEED + 6)))
        for _ in range(sizes.worker_rounds):
            for workers, (pool, rate) in enumerate(zip(pools, rates, strict=True), start=1):
                count = workers * sizes.worker_episodes
                start = time.perf_counter()
                list(pool.map(play_one, range(FIRST_SEED, FIRST_SEED + count)))
                rate.append(count / (time.perf_counter() - start))
    finally:
        for pool in pools:
            pool.shutdown()
    one, two = np.median(rates[0]), np.median(rates[1])
    how = f"{two:.2f} expert episodes a second against {one:.2f}, wall time, in turns"
    return {"two workers": at_least(two / one, 1.7, "times one's episodes", how)}


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print a line a number, write the file."""
    measures = step_lines, plan_lines, expert_lines, worker_lines
    run_bench("platformer", __doc__, measures, Sizes(), QUICK, arguments)


if __name__ == "__main__":
    main()
