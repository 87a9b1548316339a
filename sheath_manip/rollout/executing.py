"""Where episodes run, as a value: what the command line and an experiment are told."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

from sheath_manip.exceptions import ParameterError

if TYPE_CHECKING:
    # Each brings much that a command line which only prints its help can do without.
    from sheath_manip.rollout.elsewhere import ElsewhereExecutor
    from sheath_manip.rollout.serial import SerialExecutor

Kind = Literal["serial", "processes", "ray"]


@dataclass(frozen=True)
class Executing:
    """Where episodes run."""

    executor: Kind | None = None
    """None: processes, and with no workers this process"""
    workers: int | None = None
    """how many, a core each; None: as many as is usual, of Ray as many as the cluster has cores"""
    address: str | None = None
    """of Ray's cluster; None: that of RAY_ADDRESS, or one of this machine"""

    def __post_init__(self) -> None:
        if self.workers is not None and self.workers < 0:
            raise ParameterError(f"workers is {self.workers}; wanted at least 0")
        if self.executor in ("processes", "ray") and self.workers == 0:
            raise ParameterError(f"workers is 0; wanted at least 1 with {self.executor}")
        if self.executor == "serial" and self.workers:
            raise ParameterError(
                f"workers is {self.workers}; the executor serial has none: wanted processes or ray"
            )
        if self.address is not None and self.executor != "ray":
            raise ParameterError(
                f"address is {self.address}, of a cluster of Ray; wanted --executor ray as well"
            )

    def __str__(self) -> str:
        told = {name: value for name, value in vars(self).items() if value is not None}
        return ", ".join(f"{name} is {value}" for name, value in told.items())

    def by_default(self, workers: int) -> "Executing":
        """Return the same with so many worker processes where nothing was said."""
        said = self.workers is not None or self.executor in ("serial", "ray")
        return self if said else replace(self, workers=workers)

    @property
    def here(self) -> bool:
        """Whether all runs in this process."""
        return self.executor == "serial" or (self.executor is None and not self.workers)

    def made(self) -> "SerialExecutor | ElsewhereExecutor":
        """Make the executor; raises SetupError where there is no Ray, or none at the address."""
        if self.here:
            from sheath_manip.rollout.serial import SerialExecutor

            return SerialExecutor()
        return self.elsewhere()

    def elsewhere(self) -> "ElsewhereExecutor":
        """Make one that is not `here`; raises as `made` does."""
        if self.executor == "ray":
            from sheath_manip.rollout.cluster import RayExecutor

            return RayExecutor(self.workers, self.address)
        from sheath_manip.rollout.processes import ProcessExecutor

        return ProcessExecutor(1 if self.workers is None else self.workers)


TWO = Executing(workers=2)
"""two worker processes of this machine"""
