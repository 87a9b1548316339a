"""`sheath data export` and `sheath data import`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro
from rich.text import Text

from sheath_manip.cli.options import StoreAddress, default_is
from sheath_manip.cli.session import Session
from sheath_manip.dataset.exchange.selection import ActionChoice, Selection
from sheath_manip.types import Outcome

FilePath = Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="PATH")]
ByValue = tyro.conf.EnumChoicesFromValues


@dataclass(frozen=True, kw_only=True)
class ExportStore:
    """Write episodes in the format of another tool; all of it appears at once or nothing does."""

    store: StoreAddress
    """directory of the episodes, or a URL"""
    out: FilePath
    """path to write to, where nothing may be yet: for replay-buffer a directory or a .zarr.zip, for
    robomimic an .hdf5 file, else a directory"""
    format: str
    """name of the format: replay-buffer, robomimic, lerobot, minari, or that of an installed
    package"""
    successes: bool = False
    """export only episodes that succeeded"""
    expert_steps: bool = False
    """export only steps in which the expert acted, each run of them as an episode"""
    rounds: Annotated[tuple[int, ...], default_is("all")] = ()
    """export only episodes of these rounds"""
    action: Annotated[ActionChoice, ByValue] = ActionChoice.EXECUTED
    """action that is exported as `the` action; requested is what the actor asked for, before the
    command filter, and labelled leaves out the steps that nobody labelled"""
    bad_steps: bool = False
    """export also what a person marked as bad in `sheath replay`"""

    def run(self, session: Session) -> int:
        """Write it, then print what was written."""
        from sheath_manip.dataset.exchange.exporting import export
        from sheath_manip.dataset.locations import open_store

        reader = open_store(self.store)
        selection = Selection(
            self.successes, self.expert_steps, self.rounds, self.action, self.bad_steps
        )
        with session.progress("exporting", len(reader.names())) as report:
            done = export(reader, self.out, self.format, selection, report)
        session.out.print(Text(f"{self.out}: {done.episodes} episodes, {done.steps} steps"))
        for remark in done.remarks:
            session.out.print(Text(remark))
        return 0


@dataclass(frozen=True, kw_only=True)
class ImportStore:
    """Take in the episodes of another tool's file, all or none; those that are held are left out.

    What `sheath data export` wrote comes back as it was. Of another tool's file the task, the
    control rate and the meaning of its keys must be told, as far as it does not say them itself.
    """

    file: FilePath
    """file to import: a ReplayBuffer (directory or .zarr.zip), an HDF5 file of robomimic or
    robosuite, the directory of a LeRobot data set, or that, or the name, of one of Minari"""
    store: StoreAddress
    """directory for the episodes; made where there is none"""
    format: str
    """name of the format: replay-buffer, robomimic, lerobot, minari, or that of an installed
    package"""
    keys: Annotated[tuple[str, ...], default_is("the format's own")] = ()
    """what the file's keys mean: images/CAMERA=KEY, features=KEY,KEY,..., action=KEY, reward=KEY,
    state=KEY, intervention=KEY; in robomimic's files an observation is obs/NAME, in Minari's
    observations/NAME"""
    task: Annotated[str | None, default_is("as the file says")] = None
    """name of the task"""
    control_rate_hz: Annotated[float | None, default_is("as the file says")] = None
    """control steps a second of the recordings"""
    outcome: Annotated[Outcome | None, ByValue, default_is("as the file says, else success")] = None
    """how the episodes ended; demonstrations are mostly published where they succeeded"""
    method: Annotated[str | None, default_is("the file's name")] = None
    """name of the method that recorded the episodes"""
    mask: Annotated[str | None, default_is("all episodes")] = None
    """list in the file that names the episodes to take, such as robomimic's train or valid"""

    def run(self, session: Session) -> int:
        """Append them, then print how many, and what of them was taken."""
        from sheath_manip.dataset.exchange.apart import import_apart
        from sheath_manip.dataset.exchange.key_map import KeyMap
        from sheath_manip.dataset.exchange.sources import named_after, origin

        told = origin(
            self.task or "",
            self.control_rate_hz,
            KeyMap.parse(self.keys),
            outcome=self.outcome,
            method=self.method or named_after(self.file),
            mask=self.mask or "",
        )
        with session.err.status("importing"):
            done = import_apart(self.format, self.file, Path(self.store), told)
        line = f"{done.added} episodes added to {self.store}, {done.held} were there before"
        session.out.print(Text(line))
        for remark in done.remarks:
            session.out.print(Text(remark))
        if not done.sealed:
            line = f"{self.file} has no digests: no bit that changed in it is noticed"
            session.out.print(Text(line))
        return 0
