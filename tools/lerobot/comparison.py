"""One training seed of the comparison: what each method learns in its rounds."""

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

from sheath_manip.adapters.lerobot import load_policy
from sheath_manip.experiments.takeovers.schedules import Gated, random_blocks
from sheath_manip.experiments.takeovers.trial import Trial
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.gates.making import make_gate
from sheath_manip.gates.mixture import Mixture
from sheath_manip.gates.scheduled import ScheduledTakeovers
from sheath_manip.gates.takeover import RandomTakeover
from sheath_manip.protocols import Gate
from sheath_manip.seeding import generator
from sheath_manip.types import Purpose
from tools.lerobot.comparison_plan import BLOCKS, COMPARED, DAGGER, SHEATH, ComparisonPlan
from tools.lerobot.gates import OWN_LABELS, fitted_gate
from tools.lerobot.measuring import told_of
from tools.lerobot.scenes import Scenes
from tools.lerobot.workshop import Workshop, name_of


class SeedRun:
    """One training seed's run; what is done already is read from its folder."""

    def __init__(
        self, plan: ComparisonPlan, seed: int, folder: Path, say: Callable[[str], None]
    ) -> None:
        """Begin, or go on."""
        self.plan, self.say = plan, say
        self.seed = seed
        self.scenes = Scenes(plan.variant, seed)
        self.workshop = Workshop(folder, self.scenes, plan.steps, seed, say)
        self.demonstrations = self.scenes.shown(Purpose.DEMONSTRATION, plan.demonstrations)
        self.calibration = self.scenes.shown(Purpose.CALIBRATION, plan.calibration)

    def stages(self) -> Iterator[dict[str, Any]]:
        """Yield the results of all stages so far, after each."""
        yield (results := {"start": self._kept("start", self._start), "methods": {}})
        for method in COMPARED:
            for number in range(1, self.plan.rounds + 1):
                stage = self._kept(name_of(method, number), partial(self._round, method, number))
                results["methods"].setdefault(method, []).append(stage)
                yield results

    def _start(self) -> dict[str, Any]:
        _, frames = self.workshop.trained("start", self.demonstrations, [])
        return {"frames": frames, "alone": self._alone("start", 0)}

    def _round(self, method: str, number: int) -> dict[str, Any]:
        """One round of one method; after the last one its policy drives alone."""
        workshop, plan = self.workshop, self.plan
        before = workshop.learned(method, number - 1)
        last = workshop.policy(name_of(method, number - 1))
        policy = load_policy(last, spec=self.scenes.spec)
        gate = fitted_gate(policy, [*self.demonstrations, *before], self.calibration, OWN_LABELS)
        store = workshop.store(method, number)
        for index in range(plan.episodes):
            acting = self._gate(method, number, index, gate)
            self.scenes.record(store, policy, acting, method, number, index)
        episodes = workshop.episodes(method, number)
        earlier = [name_of(method, each) for each in range(number)]
        _, frames = workshop.trained(name_of(method, number), episodes, earlier)
        result = {"frames": frames, "learning": told_of(episodes)}
        if number == plan.rounds:
            result["alone"] = self._alone(method, number)
        return result

    def _gate(self, method: str, number: int, index: int, gate: FittedGate) -> Gate:
        """What drives the episode number `index` of a round."""
        if method == SHEATH:
            return make_gate(gate)
        if method == DAGGER:
            return Mixture(0.0)
        shown = self.workshop.episodes(SHEATH, number)
        if method == BLOCKS:
            trials = [Trial.of(episode, failing=False) for episode in shown]
            # It is not tried alone on the scenes that it learns on: its time is what it had there.
            own_steps = [trial.steps - trial.expert_steps for trial in trials]
            draws = generator("lerobot", BLOCKS, self.seed, number, index)
            return ScheduledTakeovers(random_blocks(Gated(trials, own_steps), index, draws))
        share = self.workshop.result(name_of(SHEATH, number))["learning"]["expert_share"]
        return RandomTakeover(share, query=False)

    def _alone(self, method: str, number: int) -> dict[str, Any]:
        policy = load_policy(self.workshop.policy(name_of(method, number)), spec=self.scenes.spec)
        episodes = self.scenes.alone(policy, method, number, self.plan.final)
        wins = [episode.outcome == "success" for episode in episodes]
        return told_of(episodes) | {"succeeds": wins}

    def _kept(self, name: str, make: Callable[[], dict[str, Any]]) -> dict[str, Any]:
        result = self.workshop.kept(name, make)
        found = result.get("alone") or result["learning"]
        self.say(f"seed {self.seed}, {name}: {found['success_rate']:.2f}")
        return result
