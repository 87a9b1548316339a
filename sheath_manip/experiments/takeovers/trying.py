"""Tries ways of taking over on scenes; what the policy did alone before a takeover is not rerun."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sheath_manip.experiments.takeovers.alone import Alone, Scene, alone_on
from sheath_manip.experiments.takeovers.plan import GateChoice
from sheath_manip.experiments.takeovers.recalled import RecallingGate
from sheath_manip.experiments.takeovers.schedules import Turns
from sheath_manip.experiments.takeovers.scoring import scene_key, scores_alone
from sheath_manip.experiments.takeovers.stretch import Stretch, StretchEnvironment
from sheath_manip.experiments.takeovers.trial import Trial
from sheath_manip.experiments.takeovers.watched import Watched
from sheath_manip.gates.patient import RequestConfig
from sheath_manip.gates.scheduled import ScheduledTakeovers
from sheath_manip.learning.checkpoint import Checkpoint, load_checkpoint
from sheath_manip.learning.drivers import PolicyAlone
from sheath_manip.protocols import Gate
from sheath_manip.rollout.cached_expert import CachedExpert
from sheath_manip.rollout.request import Crew, EpisodeRequest, run_request
from sheath_manip.support.calibration import level_threshold
from sheath_manip.types import Episode


@dataclass(frozen=True, eq=False)
class Place:
    """Where scenes are tried: one environment, and the policy that is watched over."""

    at: Watched
    lot: str
    environment: StretchEnvironment
    checkpoint: Checkpoint

    @property
    def scenes(self) -> tuple[Scene, ...]:
        """Of the lot."""
        return Alone.read(self.at, self.lot).scenes

    def alone(self, scene: Scene) -> Stretch:
        """Read what the policy alone did there."""
        return alone_on(self.at, self.environment.spec, self.lot, scene)

    def goes_on(self, alone: Stretch, first: int, gate: Gate) -> Episode:
        """Run the rest of the policy's scene from step `first` on, under a gate."""
        return self.from_state(alone, first, alone.steps[first].state, gate)

    def from_state(
        self, alone: Stretch, first: int, state: NDArray[np.float64], gate: Gate
    ) -> Episode:
        """Run the rest of the same scene from a state of its step `first`, under a gate."""
        task = self.at.task
        self.environment.steps_left = None if alone.most is None else alone.most - first
        expert = CachedExpert(task.expert(self.environment))
        request = EpisodeRequest(
            task,
            alone.info,
            PolicyAlone(self.at.checkpoint_path, alone.info.checkpoint),
            begins=state,
        )
        return run_request(request, self.environment, Crew(gate, self.checkpoint.policy, expert))


def try_gates(at: Watched, lot: str, choices: Sequence[GateChoice]) -> Iterator[list[Trial]]:
    """Try gates of one signal on all scenes of a lot; the trials of each in the scenes' order."""
    with closing(at.environment()) as environment:
        checkpoint = load_checkpoint(at.fitted_path(choices[0].signal), environment.spec)
        here = Place(at, lot, environment, checkpoint)
        episodes = {scene: here.alone(scene) for scene in here.scenes}
        scores = scores_alone(at, lot, choices[0].signal)
        held_out = np.load(at.held_out_path(choices[0].signal))
        for choice in choices:
            threshold = level_threshold([held_out], choice.level)
            yield [
                _under_gate(here, scene, alone, choice, threshold, scores[scene_key(scene)])
                for scene, alone in episodes.items()
            ]


def try_schedules(
    at: Watched, lot: str, schedules: Mapping[str, Mapping[Scene, Turns]]
) -> Iterator[tuple[str, list[Trial]]]:
    """Try schedules by name, each the expert's turns by scene, on all scenes."""
    with closing(at.environment()) as environment:
        here = Place(at, lot, environment, at.checkpoint(environment.spec))
        episodes = {scene: here.alone(scene) for scene in here.scenes}
        for name, turns in schedules.items():
            yield (
                name,
                [
                    under_schedule(here, scene, alone, turns[scene])
                    for scene, alone in episodes.items()
                ],
            )


def under_schedule(here: Place, scene: Scene, alone: Stretch, turns: Turns) -> Trial:
    """Try one schedule on one scene."""
    first = min((start for start, _ in turns), default=len(alone))
    if first >= len(alone):
        return Trial.alone(alone, scene.failing)
    episode = here.goes_on(alone, first, ScheduledTakeovers(turns, first))
    return Trial.of(episode, scene.failing, first)


def _under_gate(
    here: Place,
    scene: Scene,
    alone: Stretch,
    choice: GateChoice,
    threshold: float,
    scores: NDArray[np.float64],
) -> Trial:
    fitted = here.checkpoint.fitted
    rate_hz = here.environment.spec.control_rate_hz
    config = replace(
        fitted.config,
        minimum_hold_steps=round(choice.turn_s * rate_hz),
        dose_every_steps=round(choice.dose_every_s * rate_hz),
        # How long a turn is, the kind of gate says alone.
        requests=RequestConfig(),
        labels="own",
    )
    progress = fitted.progress if choice.notices_stuck else None
    fitted = replace(fitted, config=config, threshold=threshold, progress=progress)
    checkpoint = replace(here.checkpoint, fitted=fitted)
    gate = RecallingGate(checkpoint.gate(), alone.steps, scores)
    if gate.first is None:
        return Trial.alone(alone, scene.failing)
    return Trial.of(here.goes_on(alone, gate.first, gate), scene.failing, gate.first)
