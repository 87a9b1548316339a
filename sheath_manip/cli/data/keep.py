"""`sheath data merge`, `split`, `drop` and `repair`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro
from rich.text import Text

from sheath_manip.cli.options import StoreAddress
from sheath_manip.cli.session import Session
from sheath_manip.exceptions import ParameterError


@dataclass(frozen=True, kw_only=True)
class MergeStores:
    """Copy the episodes of stores into one; so also push to a URL, or pull from it.

    All stay where they are. What is there with the same content is not copied again, and where
    another episode has the name, as of two recordings by hand, one gets a new one. Nothing is
    copied where control rates, cameras, features or actions differ.
    """

    stores: Annotated[tyro.conf.Positional[tuple[str, ...]], tyro.conf.arg(metavar="STORE...")]
    """stores to copy from: directories or URLs"""
    into: str
    """directory or URL to copy to, such as s3://bucket/demos; begun where there is none"""

    def run(self, session: Session) -> int:
        """Copy, then print how many."""
        from sheath_manip.dataset.locations import open_store
        from sheath_manip.dataset.merging import merge

        if not self.stores:
            raise ParameterError("no store to merge; name one at least")
        sources = [open_store(address) for address in self.stores]
        target = open_store(self.into, create=True)
        total = sum(len(source.names()) for source in sources)
        with session.progress("copying", total) as report:
            done = merge(sources, target, report)
        line = f"{done.copied} episodes copied into {self.into}, {done.held} were there before"
        session.out.print(Text(line))
        for name in done.renamed:
            session.out.print(Text(f"another episode had its name: now {name}"))
        for remark in done.remarks:
            session.out.print(Text(remark))
        return 0


@dataclass(frozen=True, kw_only=True)
class SplitStore:
    """Copy the episodes of a store into new ones by chance, such as to train and to test."""

    store: StoreAddress
    """directory of the episodes, or a URL; it stays as it is"""
    parts: Annotated[tyro.conf.Positional[tuple[str, ...]], tyro.conf.arg(metavar="PART=SHARE...")]
    """names and shares of the parts, such as train=0.8 test=0.2"""
    into: Path
    """new directory for a store of each part"""
    seed: int = 0
    """seed of the draw of episodes"""

    def run(self, session: Session) -> int:
        """Copy, then print how many went where."""
        from sheath_manip.dataset.locations import open_store
        from sheath_manip.dataset.merging import split
        from sheath_manip.seeding import generator

        reader = open_store(self.store)
        with session.progress("copying", len(reader.names())) as report:
            drawn = split(
                reader,
                dict(map(_share, self.parts)),
                self.into,
                generator("split", self.seed),
                report,
            )
        for part, names in drawn.items():
            session.out.print(Text(f"{self.into / part}: {len(names)} episodes"))
        return 0


@dataclass(frozen=True, kw_only=True)
class DropEpisodes:
    """Delete episodes for good, damaged or not. Only those that are named in full."""

    store: StoreAddress
    """directory of the episodes, or a URL"""
    episodes: Annotated[tyro.conf.Positional[tuple[str, ...]], tyro.conf.arg(metavar="NAME...")]
    """names of the episodes, as `sheath data list` prints them"""

    def run(self, session: Session) -> int:
        """Delete them; none is deleted where one is not there."""
        from sheath_manip.dataset.locations import open_store
        from sheath_manip.dataset.reader import no_such_episode

        if not self.episodes:
            raise ParameterError("no episode to drop; name each, as `sheath data list` does")
        place = open_store(self.store)
        there = set(place.names())
        for name in self.episodes:
            if name not in there:
                raise no_such_episode(self.store, name)
        for name in dict.fromkeys(self.episodes):
            place.drop(name)
            session.out.print(Text(f"dropped {name}"))
        return 0


@dataclass(frozen=True, kw_only=True)
class RepairStore:
    """Sweep away what cut-off recordings left, and give misnamed episodes their names again."""

    store: StoreAddress
    """directory of the episodes"""
    idle_s: float = 600.0
    """seconds since a leftover was last written to, below which it may be a recording in
    progress"""

    def run(self, session: Session) -> int:
        """Repair, then print what was done and what is still wrong; 1 where data is affected."""
        from sheath_manip.dataset.repair import repair
        from sheath_manip.dataset.store import EpisodeStore
        from sheath_manip.dataset.table import print_check

        done = repair(EpisodeStore(self.store), self.idle_s)
        for what, names in (
            ("swept away", done.swept),
            ("has its name again:", done.renamed),
            (f"written to within {self.idle_s:g} s, so left:", done.waiting),
        ):
            for name in names:
                session.out.print(Text(f"{what} {name}"))
        return print_check(self.store, session.out)


def _share(word: str) -> tuple[str, float]:
    part, _, share = word.partition("=")
    try:
        return part, float(share)
    except ValueError:
        raise ParameterError(
            f"the part {word!r} is not NAME=SHARE; such as train=0.8 test=0.2"
        ) from None
