"""What a page moves in time: the playhead of a run, or the player of recorded episodes."""

from sheath_manip.dashboard.catalog import EpisodeCatalog
from sheath_manip.dashboard.player import Player
from sheath_manip.dashboard.playhead import Playhead


class RunSeeking:
    """Looks back into a run, which goes on meanwhile."""

    def __init__(self, playhead: Playhead) -> None:
        self._playhead = playhead

    def look_at(self, step: int) -> None:
        """Show that step until somebody goes back to the present."""
        self._playhead.look_at(step)

    def nudge(self, steps: int) -> None:
        """Look so many steps farther on, or back."""
        shown = self._playhead.shown
        if shown is not None:
            self._playhead.look_at(shown[1] + steps)

    def press(self, name: str) -> None:
        """Do nothing: the keys are the operator's."""

    def load(self, place: int, step: int | None) -> None:
        """Do nothing: a run has one episode at a time."""

    def note(self, text: str) -> None:
        """Do nothing: what runs is not on the disk yet."""


class ReplaySeeking:
    """Moves in recorded episodes, and notes what a person says of a step."""

    def __init__(self, player: Player, catalog: EpisodeCatalog) -> None:
        self._player, self._catalog = player, catalog

    def look_at(self, step: int) -> None:
        """Show that step, and stay there."""
        self._player.look_at(step)

    def nudge(self, steps: int) -> None:
        """Go so many steps on or back, and stay there."""
        self._player.nudge(steps)

    def press(self, name: str) -> None:
        """Do what a key says; any other name says nothing."""
        player = self._player
        match name:
            case "toggle":
                player.toggle()
            case "stop":
                player.stop()
            case "backwards" | "forwards":
                player.shuttle(name == "backwards")
            case "before" | "after":
                self._jump(name == "after")

    def load(self, place: int, step: int | None) -> None:
        """Show the episode at that place, where there is one."""
        if place < len(self._catalog):
            self._player.load(place, step)

    def note(self, text: str) -> None:
        """Keep a note of the step that is shown; an empty one takes it away."""
        now = self._player.now

        def work() -> None:
            marks = self._catalog.kept(now.place).with_note(now.at, text)
            self._catalog.mark(now.place, marks)
            self._player.say(f"noted at step {now.at + 1}" if text else "the note is gone")

        self._player.do(work, "marking …")

    def _jump(self, forward: bool) -> None:
        """Go to the next intervention, or the one before."""
        now = self._player.now
        if now.film is None:
            return
        starts = [start for start, _ in now.film.trace.so_far().turns]
        there = [each for each in starts if (each > now.at if forward else each < now.at)]
        if there:
            self._player.look_at(there[0] if forward else there[-1])
