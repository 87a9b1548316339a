"""The one control loop, and episodes run by it: here, in worker processes, recorded."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sheath_manip.rollout.loop import rollout

__all__ = ["rollout"]


def __getattr__(name: str) -> Any:
    # Only now: the loop brings numpy, which takes its number of threads when it is imported.
    if name == "rollout":
        from sheath_manip.rollout.loop import rollout

        return rollout
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
