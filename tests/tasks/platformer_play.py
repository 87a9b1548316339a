"""The platformer played button by button, on stages that are laid by hand."""

from collections.abc import Iterator, Sequence

import numpy as np
import pytest

from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.platformer.enemies import Enemy
from sheath_manip.tasks.platformer.game import Buttons
from sheath_manip.tasks.platformer.stage import LEAD_TILES, LENGTH_TILES, TRAIL_TILES, Block, Stage
from sheath_manip.tasks.platformer.task import CHOICES, PlatformerTask, Scenario
from sheath_manip.types import Transition

REST = Buttons(False, False, False, False)
LEFT, RIGHT = REST._replace(left=True), REST._replace(right=True)
RUN, JUMP = RIGHT._replace(speed=True), REST._replace(jump=True)
RUN_AND_JUMP = RUN._replace(jump=True)


def pressed(buttons: Buttons) -> np.ndarray:
    return np.array(buttons, np.float32)


def laid(*blocks: tuple[float, float, float], enemies: tuple[Enemy, ...] = ()) -> Stage:
    """A stage of (left, right, height); elsewhere are gaps."""
    heights = np.zeros(LEAD_TILES + LENGTH_TILES + TRAIL_TILES, np.int16)
    for left, right, height in blocks:
        heights[int(left) + LEAD_TILES : int(right) + LEAD_TILES] = height
    return Stage(heights, tuple(Block(*block) for block in blocks), enemies)


FLAT = laid((-14, 234, 3))


class Play:
    """An environment with its task, under names of their own types."""

    def __init__(self, scenario: Scenario) -> None:
        self.task = PlatformerTask(scenario)
        self.environment = ComposerEnvironment(self.task)

    def on(self, stage: Stage, x_m: float = 1.0) -> None:
        self.environment.reset(0)
        self.task.play(self.environment.physics, stage, x_m)

    def press(self, *buttons: Buttons) -> list[Transition]:
        """One step each, up to the end of the episode."""
        transitions = []
        for each in buttons:
            transitions.append(self.environment.step(pressed(each)))
            if transitions[-1].terminated or transitions[-1].truncated:
                break
        return transitions

    def heights(self, buttons: Sequence[Buttons]) -> np.ndarray:
        z = []
        for each in buttons:
            self.press(each)
            z.append(self.task.moment.z)
        return np.array(z)

    def named(self, start: str) -> dict[str, float]:
        seen = self.environment.observe().features.tolist()
        pairs = zip(self.environment.spec.feature_names, seen, strict=True)
        return {name: value for name, value in pairs if name.startswith(start)}


@pytest.fixture(scope="module")
def play() -> Iterator[Play]:
    play = Play(Scenario())
    yield play
    play.environment.close()


def buttons_at_random(count: int) -> list[Buttons]:
    rng = np.random.default_rng(1)
    return [RUN, *(CHOICES[index] for index in rng.integers(len(CHOICES), size=count))]
