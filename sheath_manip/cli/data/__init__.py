"""`sheath data`: look into an episode store, exchange it with other tools, keep it in order."""

import inspect
from dataclasses import dataclass
from typing import Annotated, Any

import tyro

from sheath_manip.cli.data.exchange import ExportStore, ImportStore
from sheath_manip.cli.data.keep import DropEpisodes, MergeStores, RepairStore, SplitStore
from sheath_manip.cli.data.look import CheckStore, ListStore, ShowEpisode
from sheath_manip.cli.examples import described
from sheath_manip.cli.options import WITHOUT_PREFIX
from sheath_manip.cli.session import Session, Verb


def _choice(name: str, verb: type[Verb]) -> Any:
    words = described(f"data {name}", inspect.getdoc(verb))
    return tyro.conf.subcommand(name, prefix_name=False, description=words)


@dataclass(frozen=True)
class Data:
    """Look into an episode store, exchange it with other tools, keep it in order."""

    what: Annotated[
        Annotated[ListStore, _choice("list", ListStore)]
        | Annotated[ShowEpisode, _choice("show", ShowEpisode)]
        | Annotated[CheckStore, _choice("check", CheckStore)]
        | Annotated[ExportStore, _choice("export", ExportStore)]
        | Annotated[ImportStore, _choice("import", ImportStore)]
        | Annotated[MergeStores, _choice("merge", MergeStores)]
        | Annotated[SplitStore, _choice("split", SplitStore)]
        | Annotated[DropEpisodes, _choice("drop", DropEpisodes)]
        | Annotated[RepairStore, _choice("repair", RepairStore)],
        WITHOUT_PREFIX,
    ]

    def run(self, session: Session) -> int:
        """Do what was asked for."""
        return self.what.run(session)
