"""`sheath replay`: a recorded episode in the browser."""

from contextlib import suppress
from dataclasses import dataclass, field

from rich.text import Text

from sheath_manip.cli.options import Address, StoreAddress
from sheath_manip.cli.session import Session
from sheath_manip.exceptions import ParameterError


@dataclass(frozen=True, kw_only=True)
class Replay:
    """Show a recorded episode in the browser, again and again until Ctrl-C."""

    store: StoreAddress
    """directory of the episodes, or a URL"""
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
        from sheath_manip.dataset.places import open_place
        from sheath_manip.dataset.show import chosen

        store = open_place(self.store)
        episode = store.read(chosen(store, self.episode))
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
