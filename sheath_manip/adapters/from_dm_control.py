"""A dm_control environment as a task: `from_dm_control("cartpole/swingup", expert=…)`."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from sheath_manip.adapters.from_gymnasium import from_gymnasium
from sheath_manip.dataset.extras import needs
from sheath_manip.exceptions import ParameterError
from sheath_manip.task import Task

with needs("gymnasium", "gymnasium"):
    from sheath_manip.adapters.dm_control_gymnasium import DmControlGymnasium


@dataclass(frozen=True)
class DmControlMaker:
    """Makes the environment with a gymnasium's face; can be pickled where `make` can."""

    make: str | Callable[[], Any]
    camera: int | str
    size_px: tuple[int, int]

    def __call__(self) -> DmControlGymnasium:
        """Make it; raises ParameterError for a name that the suite does not have."""
        return DmControlGymnasium(self._made(), self.camera, self.size_px)

    def _made(self) -> Any:
        if not isinstance(self.make, str):
            return self.make()
        with needs("tasks", "dm_control"):
            from dm_control import suite
        domain, _, task = self.make.partition("/")
        if (domain, task) not in suite.ALL_TASKS:
            raise ParameterError(
                f"dm_control's suite has no {self.make!r}; wanted DOMAIN/TASK, such as "
                "cartpole/swingup, or what makes an environment"
            )
        return suite.load(domain, task)


def from_dm_control(
    make: str | Callable[[], Any],
    *,
    name: str = "",
    metric: str = "return",
    camera: int | str = -1,
    size_px: tuple[int, int] = (84, 84),
    **settings: Any,
) -> Task:
    """Return an environment of dm_control as a task.

    Args:
        make: `DOMAIN/TASK` of the suite, or what makes an environment of the suite or of composer.
        name: of the task; by default that of the suite.
        metric: by which episodes are judged; the suite knows rewards alone, so that it takes a
            `judge` to say what success is.
        camera: of the model, that is rendered where `render` names a camera; -1 is the free one.
        size_px: (height, width) of what is rendered.
        settings: as of `from_gymnasium`, such as `expert` and `judge`; an expert that is a class is
            called with what has dm_control's `physics`.

    Raises ParameterError where a task that is not of the suite has no name.
    """
    if not (name or isinstance(make, str)):
        raise ParameterError("an environment that is not of the suite wants a name=")
    name = name or str(make).replace("/", "-")
    settings.setdefault("summary", f"{name}, of dm_control")
    return from_gymnasium(
        DmControlMaker(make, camera, size_px), name=name, metric=metric, **settings
    )
