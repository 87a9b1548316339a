"""What a robot needs of a task: how to make it, its expert, fallbacks and teleop."""

import pickle
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import UnknownNameError
from sheath_manip.protocols import Environment, Expert, Teleop

SCRIPTED = "scripted"
"""the name of a task's own expert beside its fallbacks"""
HOLD = "hold"
"""the fallback controller that leaves the robot where it is"""


@dataclass(frozen=True)
class Task:
    """A task: how to make it and who can act in it. Everything in it can be pickled.

    What is learned on it, and what is told about that, is a study's
    (`sheath_manip.experiments.study`).
    """

    name: str
    summary: str
    variants: Mapping[str, Callable[[], Environment]]
    """by name; `default` is used where none is asked for, `final` to judge last policies: without
    it they are judged on the variant that they were learned on"""
    expert: Callable[[Any], Expert]
    """from the environment, since an expert may look at the physics"""
    run_variants: Mapping[str, Callable[[int], Environment]] = field(default_factory=dict)
    """by name, from the seed of a training run: all its episodes belong to one scene of the run's
    own, such as one stage, and their seeds choose what else may differ"""
    fallbacks: Mapping[str, Callable[[Any], Expert]] = field(default_factory=dict)
    """by name, from the environment: controllers that act where the expert does not, such as
    `hold`"""
    teleop: Callable[[Any], Teleop] | None = None
    """from the environment: how a person's devices drive it; None where nobody can"""
    picture: Callable[[Any], NDArray[np.uint8]] | None = None
    """(h, w, 3) RGB of how an environment stands, for films of a task that no camera looks at, or
    none with a picture large enough"""
    require: Callable[[], None] | None = None
    """raises SetupError where this machine cannot run an episode of it, such as for want of OpenGL;
    None where any machine can"""

    def make(self, variant: str = "default") -> Environment:
        """Return a new environment; raises UnknownNameError."""
        if variant not in self.variants:
            raise UnknownNameError(f"variant of {self.name}", variant, self.variants)
        return self.variants[variant]()

    def make_expert(self, environment: Environment, name: str = SCRIPTED) -> Expert:
        """Return the expert, or the fallback of that name; raises UnknownNameError."""
        experts = {SCRIPTED: self.expert, **self.fallbacks}
        if name not in experts:
            raise UnknownNameError(f"expert of {self.name}", name, experts)
        return experts[name](environment)

    def make_hold(self, environment: Environment) -> Expert | None:
        """Return what leaves the robot where it is; None where the simulation cannot hold."""
        return self.make_expert(environment, HOLD) if HOLD in self.fallbacks else None

    def make_for_run(self, variant: str, run_seed: int) -> Environment:
        """Return a new environment for the training run of that seed; raises UnknownNameError."""
        if variant in self.run_variants:
            return self.run_variants[variant](run_seed)
        if variant not in self.variants:
            known = (*self.variants, *self.run_variants)
            raise UnknownNameError(f"variant of {self.name}", variant, known)
        return self.make(variant)

    def same_as(self, other: "Task") -> bool:
        """Return whether `other` is this task, or a copy of it that was sent here.

        Each request that comes from another process brings a task of its own, in which nothing is
        the same object, and partials are never equal: such copies are the same where they would be
        sent alike. Where it cannot be told, the answer is no.
        """
        return self is other or _sent(self) == _sent(other)


def _sent(task: Task) -> object:
    """The task as it would be sent to another process; itself where it cannot be."""
    try:
        return pickle.dumps(task)
    except Exception:
        return task
