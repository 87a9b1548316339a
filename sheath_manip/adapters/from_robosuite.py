"""A robosuite environment as a task: `from_robosuite("Lift", robots="Panda", expert=…)`."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from sheath_manip.adapters.from_gymnasium import from_gymnasium
from sheath_manip.dataset.extras import needs
from sheath_manip.exceptions import SetupError
from sheath_manip.task import Task

with needs("gymnasium", "gymnasium"):
    from sheath_manip.adapters.robosuite_gymnasium import RobosuiteGymnasium


@dataclass(frozen=True)
class RobosuiteMaker:
    """Makes the environment with a gymnasium's face; can be pickled where `make` can."""

    make: str | Callable[..., Any]
    settings: Mapping[str, Any]

    def __call__(self) -> RobosuiteGymnasium:
        """Make it; raises SetupError where robosuite is not installed."""
        try:
            import robosuite  # pyright: ignore[reportMissingImports]
        except ImportError as error:
            raise SetupError(
                f"this wants the package robosuite ({error}); install it with "
                "`pip install robosuite 'mujoco<3.8'` in a venv of its own"
            ) from error
        make = partial(robosuite.make, self.make) if isinstance(self.make, str) else self.make
        inner = make(**self.settings)
        if not inner.hard_reset:
            _draw_alike(inner)
        return RobosuiteGymnasium(inner)


def _draw_alike(inner: Any) -> None:
    """Load the model again, with what is drawn for it, such as a cube's size, from a fixed seed.

    It is loaded once, and a scene is to be the same wherever it is made again.
    """
    inner.hard_reset = True
    RobosuiteGymnasium(inner).reset(seed=0)
    inner.hard_reset = False


def from_robosuite(
    make: str | Callable[..., Any],
    *,
    name: str = "",
    settings: Mapping[str, Any] | None = None,
    cameras: Mapping[str, tuple[int, int]] | None = None,
    **taken: Any,
) -> Task:
    """Return an environment of robosuite as a task; success is what robosuite says it is.

    Args:
        make: name of the environment, such as `Lift`, or what makes one of the settings.
        name: of the task; by default robosuite's in small letters.
        settings: of robosuite's own `make`, such as `robots` and `horizon`. Nothing is shown in a
            window, and the model is loaded once: `hard_reset` is off.
        cameras: (height, width) in pixels of those to see through; their images are CAMERA_image.
        taken: as of `from_gymnasium`, such as `expert` and `leave_out`.
    """
    cameras = cameras or {}
    made = {
        "has_renderer": False,
        "has_offscreen_renderer": bool(cameras),
        "use_camera_obs": bool(cameras),
        "hard_reset": False,
        "ignore_done": True,
        **(settings or {}),
    }
    if cameras:
        heights, widths = zip(*cameras.values(), strict=True)
        made |= {
            "camera_names": list(cameras),
            "camera_heights": list(heights),
            "camera_widths": list(widths),
        }
    name = name or str(make).lower()
    taken.setdefault("summary", f"{make if isinstance(make, str) else name}, of robosuite")
    return from_gymnasium(RobosuiteMaker(make, made), name=name, **taken)
