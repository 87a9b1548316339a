"""Tasks of this framework for gymnasium: `to_gymnasium(TASK)`, and every task of a table by its id.

Once this module is imported, `gymnasium.make("sheath/grasp-clutter-v0", variant="final")` makes
those of the house and of installed packages. Since its version 1 gymnasium looks for no plugins, so
one line must import it; `gymnasium.make("sheath_manip.adapters.to_gymnasium:sheath/driving-v0")`
does it, too.
"""

import re
from importlib.metadata import entry_points

from sheath_manip.dataset.extras import needs
from sheath_manip.task import Task

with needs("gymnasium", "gymnasium"):
    import gymnasium
    from gymnasium.envs.registration import EnvSpec

    from sheath_manip.adapters.task_env import TaskEnv

HOUSE = ("driving", "gauze-cutting", "grasp-clutter", "platformer")
FROM_TABLE = "sheath_manip.command:task_env"
"""what makes the environment of a task in a table; it brings the simulator of the house's"""


def to_gymnasium(
    task: Task, variant: str = "default", *, run_seed: int = 0, render_mode: str | None = None
) -> TaskEnv:
    """Return a task as a gymnasium environment, which passes gymnasium's `check_env`.

    Args:
        task: to be run; one of somebody's own, or of `from_gymnasium`, as well as the house's.
        variant: of the task.
        run_seed: of the training run, for variants in which each has a scene of its own.
        render_mode: `rgb_array` for pictures, or None.

    Raises UnknownNameError for a variant that there is not, and SetupError where this machine
    cannot run the task.
    """
    env = TaskEnv(task, variant, run_seed, render_mode)
    settings = {"variant": variant, "run_seed": run_seed, "render_mode": render_mode}
    again = f"{__name__}:{to_gymnasium.__name__}"
    env.spec = EnvSpec(environment_id(task.name), again, kwargs={"task": task, **settings})
    return env


def environment_id(task: str) -> str:
    """Return the id of the task of that name: `sheath/NAME-v0`."""
    return f"sheath/{re.sub(r'[^a-zA-Z0-9_.-]', '-', task)}-v0"


def register_tasks() -> None:
    """Give every task of the tables its id; those that are registered already are left alone."""
    for name in (*HOUSE, *entry_points(group="sheath.tasks").names):
        identity = environment_id(name)
        if identity not in gymnasium.registry:
            gymnasium.register(identity, FROM_TABLE, kwargs={"task": name})


register_tasks()
