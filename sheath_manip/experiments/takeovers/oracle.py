"""The fewest and latest turns that would have done: found by trying them, which no gate can."""

from collections.abc import Callable, Sequence
from contextlib import closing

from sheath_manip.experiments.takeovers.alone import Scene
from sheath_manip.experiments.takeovers.schedules import Turns
from sheath_manip.experiments.takeovers.stretch import Stretch
from sheath_manip.experiments.takeovers.trial import Trial
from sheath_manip.experiments.takeovers.trying import Place
from sheath_manip.experiments.takeovers.watched import Watched
from sheath_manip.gates import AlwaysExpert
from sheath_manip.gates.scheduled import ScheduledTakeovers
from sheath_manip.types import Episode, Outcome, Step

LEAD_STEPS = 2
"""before the last step from which the expert still succeeds"""
MOST_TURNS = 4
"""an episode"""


def try_oracle(at: Watched, lot: str, scenes: int) -> list[Trial]:
    """Try it on the first failing scenes of a lot."""
    with closing(at.environment()) as environment:
        here = Place(at, lot, environment, at.checkpoint(environment.spec))
        failing = [scene for scene in here.scenes if scene.failing][:scenes]
        return [_saved(here, scene) for scene in failing]


def last_saving_step(first: int, steps: int, saves: Callable[[int], bool]) -> int | None:
    """Return the last of the steps `first` .. `steps` - 1 from which the expert still succeeds.

    Found by halving, as if it could be saved before and could not be afterwards; None where it
    cannot be saved from the first.
    """
    if first >= steps or not saves(first):
        return None
    low, high = first, steps
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if saves(middle) else (low, middle)
    return low


def _saved(here: Place, scene: Scene) -> Trial:
    """Put the expert in just before it is too late, again and again until the scene succeeds."""
    alone = here.alone(scene)
    rate_hz = here.environment.spec.control_rate_hz
    turn_steps = max(1, round(here.at.plan.oracle_turn_s * rate_hz))
    outcome, begun, turns = alone.outcome, 0, []
    steps: list[Step] = list(alone.steps)
    while outcome is not Outcome.SUCCESS and len(turns) < MOST_TURNS:
        after = turns[-1][0] + turns[-1][1] if turns else 0
        driven = _Driven(here, alone, steps)
        last = last_saving_step(after, len(steps), driven.saved_from)
        if last is None:
            break
        begun = max(after, last - LEAD_STEPS)
        turns.append((begun, turn_steps))
        episode = driven.goes_on(begun, turns)
        outcome = episode.outcome
        steps = [*steps[:begun], *episode.steps]
    done = tuple((start, min(count, len(steps) - start)) for start, count in turns)
    return Trial(alone.info.seed, scene.failing, outcome, len(steps), done)


class _Driven:
    """An episode so far, which can be gone on with from each of its steps."""

    def __init__(self, here: Place, alone: Stretch, steps: Sequence[Step]) -> None:
        self.here, self.alone, self.steps = here, alone, steps

    def saved_from(self, step: int) -> bool:
        """Tell whether the expert succeeds from there."""
        state = self.steps[step].state
        episode = self.here.from_state(self.alone, step, state, AlwaysExpert())
        return episode.outcome is Outcome.SUCCESS

    def goes_on(self, step: int, turns: Turns | list[tuple[int, int]]) -> Episode:
        """Run the rest under these turns."""
        gate = ScheduledTakeovers(turns, step)
        return self.here.from_state(self.alone, step, self.steps[step].state, gate)
