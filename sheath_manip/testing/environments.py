"""What every task and its environments must do."""

import pickle

import numpy as np

from sheath_manip.protocols import Environment, Restorable, Viewable
from sheath_manip.task import Task
from sheath_manip.testing.experts import check_expert
from sheath_manip.testing.sentences import wants, wants_a, wants_equal, wants_refusal
from sheath_manip.types import Observation, Outcome, Transition

STEPS = 6


def check_task(task: Task) -> None:
    """Check a task: its variants, its expert, its fallbacks and its teleop."""
    wants(bool(task.name and task.summary), "a task must have a name and a summary")
    wants("default" in task.variants, "a task must have a variant `default`")
    wants(pickle.loads(pickle.dumps(task)).name == task.name, "a task must survive pickling")
    wants_refusal(lambda: task.make("nonesuch"), "a variant that there is not must be refused")
    environment = task.make()
    try:
        wants(
            environment.spec.name == task.name,
            f"the spec is of {environment.spec.name!r}, the task is named {task.name!r}",
        )
        check_environment(environment)
        for name in ("scripted", *task.fallbacks):
            check_expert(lambda at, name=name: task.make_expert(at, name), environment)
        if task.teleop is not None:
            codes = [code for key in task.teleop(environment).guide for code in key.codes]
            wants(len(codes) == len(set(codes)), "a key must have one purpose")
    finally:
        environment.close()


def check_environment(environment: Environment) -> None:
    """Check an environment: seeded and as its spec says; and what it can do beyond that.

    That is to be restored, and to be looked at in 3-D, where it is `Restorable` and `Viewable`.
    """
    spec = environment.spec
    wants(spec.control_rate_hz > 0 and spec.max_steps > 0, "rate and length must be positive")
    rng = np.random.default_rng(0)
    choices = spec.action.choices
    actions = [
        rng.uniform(spec.action.minimum, spec.action.maximum).astype(np.float32)
        if choices is None
        else choices[rng.integers(len(choices))]
        for _ in range(STEPS)
    ]

    def driven() -> list[Observation]:
        seen = [wants_a(Observation, environment.reset(5), "reset")]
        for action in actions:
            transition = wants_a(Transition, environment.step(action), "step")
            seen.append(wants_a(Observation, transition.observation, "step"))
            if transition.terminated or transition.truncated:
                break
        return seen

    first = driven()
    for observation in first:
        shapes = {camera: image.shape[:2] for camera, image in observation.images.items()}
        wants(shapes == dict(spec.cameras), f"images are {shapes}; the spec says {spec.cameras}")
        wants(
            observation.features.shape == (len(spec.feature_names),),
            f"features have shape {observation.features.shape}; "
            f"the spec names {len(spec.feature_names)}",
        )
    wants(isinstance(environment.outcome(), Outcome), "outcome must be an Outcome")
    wants(spec.metric in environment.metrics(), f"metrics lack {spec.metric!r}, the spec's own")
    if isinstance(environment, Viewable):
        _check_view(environment)
    if isinstance(environment, Restorable):
        state = environment.state()
        seen = environment.restore(state)
        _wants_same(seen, first[-1], "restoring a state must show it as it was")
        wants_equal(environment.state(), state, "restoring a state must leave that state")
    for one, again in zip(first, driven(), strict=True):
        _wants_same(again, one, "the same seed and actions must give the same episode to the bit")


def _check_view(environment: Viewable) -> None:
    bodies = environment.pose().bodies
    wants(bodies.ndim == 2 and bodies.shape[1] == 7, "a pose must have (b, 7) bodies")
    for geom in environment.scene():
        wants(geom.body < len(bodies), f"a shape is on body {geom.body}, of {len(bodies)}")


def _wants_same(found: Observation, wanted: Observation, sentence: str) -> None:
    wants_equal(found.features, wanted.features, sentence)
    for camera, image in wanted.images.items():
        wants_equal(found.images[camera], image, sentence)
