"""`sheath replay`: a recorded episode in the browser."""

from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from rich.text import Text

from sheath_manip.cli.data import StorePath
from sheath_manip.cli.options import Address
from sheath_manip.cli.session import Session
from sheath_manip.exceptions import ParameterError, StoreError


@dataclass(frozen=True, kw_only=True)
class Replay:
    """Show a recorded episode in the browser, again and again until Ctrl-C."""

    store: StorePath
    """directory of the episodes"""
    episode: str = "0"
    """name, or place in `sheath data list`, from 0; -1 is the last"""
    speed: float = 1.0
    """1 is the episode's control rate, 2 twice as fast"""
    variant: str = "default"
    """of the task that it was recorded in, such as the `variant` of an experiment's plan"""
    once: bool = False
    """end after the first time"""
    address: Address = field(default_factory=Address)

    def run(self, session: Session) -> int:
        """Replay it."""
        if not self.speed > 0:
            raise ParameterError(f"speed is {self.speed}; wanted more than 0, such as 1")
        # Only now: other verbs need no store and no page.
        from sheath_manip.cli.episodes import opened
        from sheath_manip.dataset.store import EpisodeStore

        store = EpisodeStore(self.store)
        episode = store.read(_chosen(store.names(), self.episode, self.store))
        task = session.task(episode.info.task)
        from sheath_manip.dashboard import replay

        with (
            opened(task, self.variant, episode.info.run_seed) as environment,
            self.address.dashboard(environment.spec, session) as page,
            suppress(KeyboardInterrupt),
        ):
            while True:
                session.out.print(Text(f"{self.store}: {len(episode)} steps, {episode.outcome}"))
                replay(page, environment, episode, self.speed)
                if self.once:
                    break
        return 0


def _chosen(names: list[str], wanted: str, store: Path) -> str:
    """The name of the episode that `wanted` names or counts."""
    if wanted in names:
        return wanted
    try:
        return names[int(wanted)]
    except (ValueError, IndexError):
        raise StoreError(
            f"{store} has no episode {wanted!r}; wanted a name of `sheath data list`, or a number "
            f"below {len(names)}"
        ) from None
