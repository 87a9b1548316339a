"""Options of verbs whose episodes may run in other processes, or on other machines."""

from dataclasses import dataclass
from typing import Annotated

from sheath_manip.cli.options import default_is
from sheath_manip.rollout.executing import Executing, Kind


@dataclass(frozen=True)
class Where:
    """Where episodes run."""

    executor: Annotated[Kind | None, default_is("processes, or serial without workers")] = None
    """what runs the episodes: this process one after the other, worker processes of this machine,
    or workers of a cluster of Ray"""
    workers: Annotated[
        int | None, default_is("0, of an experiment at most 2, of Ray all cores")
    ] = None
    """number of workers; with 0 all runs in this process"""
    address: Annotated[str | None, default_is("RAY_ADDRESS, or a cluster of this machine")] = None
    """address of Ray's cluster, such as auto or HOST:6379"""

    @property
    def executing(self) -> Executing:
        """The same as a value; raises ParameterError where one option contradicts another."""
        return Executing(self.executor, self.workers, self.address)
