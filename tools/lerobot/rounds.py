"""Rounds of learning: gated episodes, LeRobot trains on all so far, the gate is fitted again."""

import json
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from sheath_manip.adapters.lerobot import load_policy
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.files.json_files import plain, write_json
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.gates.making import make_gate
from sheath_manip.gates.mixture import Mixture
from sheath_manip.gates.takeover import RandomTakeover
from sheath_manip.protocols import Gate
from sheath_manip.types import Episode, Purpose
from tools.lerobot.bars import METHODS
from tools.lerobot.gates import FALSE_ALARM_RATE, false_alarms, fitted_gate
from tools.lerobot.measuring import judged_as_given, passes_alone, told_of
from tools.lerobot.own_loop import own_episodes
from tools.lerobot.plan import Plan, claim
from tools.lerobot.scenes import Scenes
from tools.lerobot.sets import join_sets, write_set
from tools.lerobot.training import CHUNK, POLICY, train_act

FRESH = 90
"""number of a round that there is none of, whose scenes are for demonstrations that are fresh"""


class Run:
    """One seed's run; what is done already is read from its folder."""

    def __init__(self, plan: Plan, folder: Path, say: Callable[[str], None]) -> None:
        """Begin or go on; raises ParameterError where `folder` is another plan's."""
        claim(folder, plan)
        self.plan, self.folder, self.say = plan, folder, say
        self.scenes = Scenes(plan.variant, plan.seed)
        self.demonstrations = self.scenes.shown(Purpose.DEMONSTRATION, plan.demonstrations)
        self.calibration = self.scenes.shown(Purpose.CALIBRATION, plan.calibration)

    def stages(self) -> Iterator[dict[str, Any]]:
        """Yield the results of all stages so far, after each."""
        yield (results := {"start": self._kept("start", self._start), "methods": {}})
        for number in range(1, self.plan.rounds + 1):
            for method in METHODS:
                stage = self._kept(f"{method}-{number}", partial(self._round, method, number))
                results["methods"].setdefault(method, []).append(stage)
                yield results

    def _start(self) -> dict[str, Any]:
        """The policy of the demonstrations alone, in both loops, and its gate."""
        plan, scenes = self.plan, self.scenes
        path, frames = self._trained("start", self.demonstrations, [])
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
        before = self._learned(method, number - 1)
        last = f"{method}-{number - 1}" if number > 1 else "start"
        policy = load_policy(self._policy(last), spec=self.scenes.spec)
        gate = fitted_gate(policy, [*self.demonstrations, *before], self.calibration)
        acting = self._gate(method, number, gate)
        store = self._store(method, number)
        self.scenes.record(store, policy, acting, method, number, self.plan.episodes)
        episodes = _read(store)
        earlier = ["start", *(f"{method}-{each}" for each in range(1, number))]
        path, frames = self._trained(f"{method}-{number}", episodes, earlier)
        alone = self.scenes.alone(
            load_policy(path, spec=self.scenes.spec), method, number, self.plan.final
        )
        return {"frames": frames, "learning": told_of(episodes), "alone": told_of(alone)}

    def _gate(self, method: str, number: int, gate: FittedGate) -> Gate:
        if method == "sheath":
            return make_gate(gate)
        if method == "random-takeover":
            sheath = json.loads(self._file(f"sheath-{number}").read_text())
            return RandomTakeover(sheath["learning"]["expert_share"])
        return Mixture(0.0)

    def _learned(self, method: str, last: int) -> list[Episode]:
        """The episodes of a method's rounds up to the `last`."""
        return [
            episode
            for number in range(1, last + 1)
            for episode in _read(self._store(method, number))
        ]

    def _store(self, method: str, number: int) -> EpisodeStore:
        path = self.folder / f"{method}-{number}-episodes"
        return EpisodeStore(path) if path.exists() else EpisodeStore.create(path)

    def _trained(
        self, name: str, learned: Sequence[Episode], before: Sequence[str]
    ) -> tuple[Path, int]:
        """The directory of a policy trained on `learned` and the sets of before, and the frames."""
        fresh = self.folder / f"{name}-set"
        frames = write_set(fresh, learned, self.scenes.spec, self.scenes.robot)
        sets = [*(self.folder / f"{each}-set" for each in before), fresh]
        data = join_sets(sets, self.folder / f"{name}-all")
        self.say(f"{name}: {frames} new frames, LeRobot trains")
        out = self.folder / f"{name}-policy"
        return train_act(data, out, steps=self.plan.steps, seed=self.plan.seed), frames

    def _policy(self, name: str) -> Path:
        return self.folder / f"{name}-policy" / POLICY

    def _kept(self, name: str, make: Callable[[], dict[str, Any]]) -> dict[str, Any]:
        path = self._file(name)
        if not path.exists():
            write_json(path, plain(make()))
        result = json.loads(path.read_text())
        self.say(f"{name}: alone {result['alone']['success_rate']:.2f}")
        return result

    def _file(self, name: str) -> Path:
        return self.folder / f"{name}.json"


def _read(store: EpisodeStore) -> list[Episode]:
    return list(store.read_many(sorted(store.names())))
