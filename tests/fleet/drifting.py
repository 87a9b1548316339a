"""What drives the corridor of a fleet: a policy that goes straight on, and a gate that asks."""

from dataclasses import dataclass, replace

import numpy as np

from sheath_manip.gates import SupportGate
from sheath_manip.protocols import Environment
from sheath_manip.rollout.request import Crew, EpisodeRequest
from sheath_manip.task import Task
from sheath_manip.types import Action, EpisodeInfo, Observation, Outcome, Purpose
from tests.judging import ByObservation
from tests.toy import CORRIDOR, Corridor
from tools.scripted_person import Absent, Held

ASKS_FROM_M = 0.4
"""beside the middle; the wall is at one metre"""


def straight_on() -> Action:
    return np.zeros(1, np.float32)


@dataclass(frozen=True)
class Drifting:
    """Goes with the wind until the gate asks, at `from_m` beside the middle."""

    from_m: float = ASKS_FROM_M

    def crew(self, task: Task, environment: Environment) -> Crew:
        def score(observation: Observation) -> float:
            return self.from_m - abs(float(observation.features[0]))

        gate = SupportGate(ByObservation(score), 0.0)
        return Crew(gate, Absent(straight_on), task.make_expert(environment))


@dataclass(frozen=True)
class Breaking:
    """Cannot be made."""

    def crew(self, task: Task, environment: Environment) -> Crew:
        del task, environment
        raise RuntimeError("no such arm")


class Wide(Corridor):
    """So long and wide that no episode ends while a test looks."""

    def __init__(self) -> None:
        super().__init__(steps=100_000)

    def outcome(self) -> Outcome:
        return Outcome.TIME_LIMIT


WIDE = replace(CORRIDOR, variants={"final": Wide, "default": Wide})


def requests(count: int, driver: Drifting | None = None) -> list[EpisodeRequest]:
    """Scenes in which nobody who goes straight on comes through; of the long corridor."""
    infos = [
        EpisodeInfo(
            "corridor", seed, Purpose.LEARNING, 50.0, method="sheath", index=index, variant="final"
        )
        for index, seed in enumerate(_HARD[:count])
    ]
    return [EpisodeRequest(CORRIDOR, info, driver or Drifting()) for info in infos]


def sidestep(action: Action) -> Held:
    """The key that steps aside so."""
    if action[0] == 0:
        return Held(keys=frozenset({"KeyK"}))
    return Held(keys=frozenset({"KeyJ" if action[0] < 0 else "KeyL"}))


def _fails_alone(seed: int) -> bool:
    rng = np.random.default_rng(seed)
    side_m = rng.uniform(-0.3, 0.3) + np.cumsum(rng.uniform(-0.2, 0.2, 24))
    return bool(np.any(np.abs(side_m) > 1.0))


_HARD = [seed for seed in range(400) if _fails_alone(seed)]
