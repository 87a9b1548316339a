"""A task whose episodes a person may end."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from sheath_manip.cockpit.cockpit import Cockpit
from sheath_manip.cockpit.environment import OperatedEnvironment
from sheath_manip.protocols import Environment, Expert
from sheath_manip.task import Task


def operated(task: Task, cockpit: Cockpit) -> Task:
    """Return `task` with episodes that the person at `cockpit` may end.

    Its experts know the environment inside, since they look at the physics.
    """
    made = partial(_made, cockpit)
    return replace(
        task,
        expert=partial(_made_inside, task.expert),
        fallbacks={name: partial(_made_inside, make) for name, make in task.fallbacks.items()},
        variants=_Operated(task.variants, made),
        run_variants={name: partial(made, make) for name, make in task.run_variants.items()},
    )


@dataclass(frozen=True, eq=False)
class _Operated(Mapping[str, Callable[[], Environment]]):
    """Variants whose environments a person may end: those that are listed, and those that are not.

    A task may know more variants than it lists, such as one for each file of an arm.
    """

    variants: Mapping[str, Callable[[], Environment]]
    made: Callable[..., Environment]

    def __getitem__(self, name: str) -> Callable[[], Environment]:
        return partial(self.made, self.variants[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self.variants)

    def __len__(self) -> int:
        return len(self.variants)


def _made(cockpit: Cockpit, make: Callable[..., Environment], *seed: int) -> OperatedEnvironment:
    return OperatedEnvironment(make(*seed), cockpit)


def _made_inside(make: Callable[[Any], Expert], environment: Environment) -> Expert:
    operated = isinstance(environment, OperatedEnvironment)
    return make(environment.environment if operated else environment)
