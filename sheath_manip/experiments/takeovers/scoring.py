"""Gates fitted around a policy, and their scores of what it did alone."""

import dataclasses
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.experiments.gates.remembered import Shared
from sheath_manip.experiments.takeovers.alone import Alone, Scene, alone_episode
from sheath_manip.experiments.takeovers.plan import FRESH, TUNING
from sheath_manip.experiments.takeovers.watched import Watched
from sheath_manip.files.outputs import written_aside
from sheath_manip.gates.config import planned_signal
from sheath_manip.learning.fitting import Looks, fit_to_looks
from sheath_manip.policies import make_policy
from sheath_manip.policies.agreement import held_out_agreement
from sheath_manip.policies.looking import look, look_with_displaced
from sheath_manip.policies.readings import each_once
from sheath_manip.protocols import Report, TrainablePolicy
from sheath_manip.seeding import seed_for
from sheath_manip.types import TaskSpec
from sheath_manip.types.samples import Samples, visited_from


def fit_and_score(at: Watched, report: Report) -> None:
    """Fit a gate for each of the plan's signals, and score with it."""
    spec = at.spec()
    checkpoint = at.checkpoint(spec)
    policy, states = checkpoint.policy, at.states(checkpoint)
    shared = Shared()
    configs = {name: at.config(name) for name in at.plan.signals}
    signals = {name: shared.signal(planned_signal(each)) for name, each in configs.items()}
    readers = each_once(reader for each in signals.values() for reader in each.attach(policy))
    displacing = any(each.uses_displaced for each in signals.values())
    looks = Looks(
        states.labels,
        look_with_displaced(policy, states, readers, displacing),
        [look(policy, episode, readers) for episode in at.calibration(checkpoint)],
    )
    alone = {
        lot: {
            scene_key(scene): look(policy, _states_of(at, spec, lot, scene), readers)
            for scene in Alone.read(at, lot).scenes
        }
        for lot in (TUNING, FRESH)
    }

    def fresh_policy() -> TrainablePolicy:
        config = at.learning.policy
        return make_policy(config.name, spec, seed_for("policy", at.seed), **config.settings)

    def agreement() -> NDArray[np.bool_]:
        return held_out_agreement(fresh_policy, states, tolerance=spec.action.tolerance)

    for name, signal in signals.items():
        fitted = fit_to_looks(
            policy,
            signal,
            looks,
            configs[name],
            sources=checkpoint.fitted.sources,
            agreement=agreement,
        )
        held_out = np.concatenate([fitted.scores_of(seen) for seen in looks.calibration])
        with written_aside(at.held_out_path(name)) as aside, aside.open("wb") as file:
            np.save(file, held_out)
        for lot, scenes in alone.items():
            scores: dict[str, Any] = {
                index: fitted.scores_of(seen) for index, seen in scenes.items()
            }
            with written_aside(at.scores_path(lot, name)) as aside, aside.open("wb") as file:
                np.savez(file, **scores)
        # Last: where it is, the others are.
        dataclasses.replace(checkpoint, fitted=fitted).save(at.fitted_path(name))
        report(f"{at.study.name} {at.name} gate {name}")


def scores_alone(at: Watched, lot: str, signal: str) -> dict[str, NDArray[np.float64]]:
    """Return a signal's (T,) scores of the policy's steps alone, by `scene_key`."""
    with np.load(at.scores_path(lot, signal), allow_pickle=False) as content:
        return {key: content[key] for key in content.files}


def scene_key(scene: Scene) -> str:
    """Return the name of a scene's scores."""
    return f"{scene.index}-{scene.first_step}"


def _states_of(at: Watched, spec: TaskSpec, lot: str, scene: Scene) -> Samples:
    """What the policy saw alone on a scene."""
    states = visited_from([alone_episode(at, spec, lot, scene.index)])
    most = at.stretch_steps(spec) or len(states)
    last = min(scene.first_step + most, len(states))
    return states.take(np.arange(scene.first_step, last))
