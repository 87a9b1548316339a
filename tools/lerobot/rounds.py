"""Rounds of learning: gated episodes, LeRobot trains on all so far, the gate is fitted again."""

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

from sheath_manip.adapters.lerobot import load_policy
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.gates.making import make_gate
from sheath_manip.gates.mixture import Mixture
from sheath_manip.gates.takeover import RandomTakeover
from sheath_manip.protocols import Gate
from sheath_manip.types import Purpose
from tools.lerobot.bars import METHODS
from tools.lerobot.gates import FALSE_ALARM_RATE, false_alarms, fitted_gate
from tools.lerobot.measuring import judged_as_given, passes_alone, told_of
from tools.lerobot.own_loop import own_episodes
from tools.lerobot.plan import Plan, claim
from tools.lerobot.scenes import Scenes
from tools.lerobot.training import CHUNK
from tools.lerobot.workshop import Workshop, name_of

FRESH = 90
"""number of a round that there is none of, whose scenes are for demonstrations that are fresh"""


class Run:
    """One seed's run; what is done already is read from its folder."""

    def __init__(self, plan: Plan, folder: Path, say: Callable[[str], None]) -> None:
        """Begin or go on; raises ParameterError where `folder` is another plan's."""
        claim(folder, plan)
        self.plan, self.say = plan, say
        self.scenes = Scenes(plan.variant, plan.seed)
        self.workshop = Workshop(folder, self.scenes, plan.steps, plan.seed, say)
        self.demonstrations = self.scenes.shown(Purpose.DEMONSTRATION, plan.demonstrations)
        self.calibration = self.scenes.shown(Purpose.CALIBRATION, plan.calibration)

    def stages(self) -> Iterator[dict[str, Any]]:
        """Yield the results of all stages so far, after each."""
        yield (results := {"start": self._kept("start", self._start), "methods": {}})
        for number in range(1, self.plan.rounds + 1):
            for method in METHODS:
                stage = self._kept(name_of(method, number), partial(self._round, method, number))
                results["methods"].setdefault(method, []).append(stage)
                yield results

    def _start(self) -> dict[str, Any]:
        """The policy of the demonstrations alone, in both loops, and its gate."""
        plan, scenes = self.plan, self.scenes
        path, frames = self.workshop.trained("start", self.demonstrations, [])
        policy = load_policy(path, spec=scenes.spec)
        ours, passes = passes_alone(scenes, policy, plan.final)
        seeds = [episode.info.seed for episode in ours]
        theirs = own_episodes(path, scenes.environment, seeds, scenes.robot)
        gate = fitted_gate(policy, self.demonstrations, self.calibration)
        fresh = scenes.shown(Purpose.LEARNING, plan.fresh, FRESH)
        return {
            "frames": frames,
            "alone": told_of(ours),
            "lerobots_own_loop": {
                "successes": sum(outcome == "success" for outcome, _ in theirs),
                "same_outcome_and_length": sum(
                    (str(episode.outcome), len(episode)) == other
                    for episode, other in zip(ours, theirs, strict=True)
                ),
            },
            "forward_passes": passes,
            "chunks": sum(-(-len(episode) // CHUNK) for episode in ours),
            "false_alarms": {
                "asked": FALSE_ALARM_RATE,
                "found": false_alarms(gate, fresh),
                "episodes": len(fresh),
            },
            "judged": judged_as_given(scenes, policy, gate, plan.judged),
        }

    def _round(self, method: str, number: int) -> dict[str, Any]:
        """One round of one method, and how its policy does alone."""
        workshop, before = self.workshop, self.workshop.learned(method, number - 1)
        last = workshop.policy(name_of(method, number - 1))
        policy = load_policy(last, spec=self.scenes.spec)
        gate = fitted_gate(policy, [*self.demonstrations, *before], self.calibration)
        acting = self._gate(method, number, gate)
        store = workshop.store(method, number)
        for index in range(self.plan.episodes):
            self.scenes.record(store, policy, acting, method, number, index)
        episodes = workshop.episodes(method, number)
        earlier = [name_of(method, each) for each in range(number)]
        path, frames = workshop.trained(name_of(method, number), episodes, earlier)
        alone = self.scenes.alone(
            load_policy(path, spec=self.scenes.spec), method, number, self.plan.final
        )
        return {"frames": frames, "learning": told_of(episodes), "alone": told_of(alone)}

    def _gate(self, method: str, number: int, gate: FittedGate) -> Gate:
        if method == "sheath":
            return make_gate(gate)
        if method == "random-takeover":
            sheath = self.workshop.result(name_of("sheath", number))
            return RandomTakeover(sheath["learning"]["expert_share"])
        return Mixture(0.0)

    def _kept(self, name: str, make: Callable[[], dict[str, Any]]) -> dict[str, Any]:
        result = self.workshop.kept(name, make)
        self.say(f"{name}: alone {result['alone']['success_rate']:.2f}")
        return result
