"""`sheath data`: look into an episode store, exchange it with other tools, keep it in order."""

from dataclasses import dataclass
from typing import Annotated

import tyro

from sheath_manip.cli.data.exchange import ExportStore, ImportStore
from sheath_manip.cli.data.keep import DropEpisodes, MergeStores, RepairStore, SplitStore
from sheath_manip.cli.data.look import CheckStore, ListStore, ShowEpisode
from sheath_manip.cli.options import WITHOUT_PREFIX
from sheath_manip.cli.session import Session


@dataclass(frozen=True)
class Data:
    """Look into an episode store, exchange it with other tools, keep it in order."""

    what: Annotated[
        Annotated[ListStore, tyro.conf.subcommand("list", prefix_name=False)]
        | Annotated[ShowEpisode, tyro.conf.subcommand("show", prefix_name=False)]
        | Annotated[CheckStore, tyro.conf.subcommand("check", prefix_name=False)]
        | Annotated[ExportStore, tyro.conf.subcommand("export", prefix_name=False)]
        | Annotated[ImportStore, tyro.conf.subcommand("import", prefix_name=False)]
        | Annotated[MergeStores, tyro.conf.subcommand("merge", prefix_name=False)]
        | Annotated[SplitStore, tyro.conf.subcommand("split", prefix_name=False)]
        | Annotated[DropEpisodes, tyro.conf.subcommand("drop", prefix_name=False)]
        | Annotated[RepairStore, tyro.conf.subcommand("repair", prefix_name=False)],
        WITHOUT_PREFIX,
    ]

    def run(self, session: Session) -> int:
        """Do what was asked for."""
        return self.what.run(session)
