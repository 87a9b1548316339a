"""What a person says of the episode afterwards: its outcome, and stretches not to learn from."""

from collections.abc import Callable
from dataclasses import replace
from html import escape

import viser

from sheath_manip.dashboard.catalog import EpisodeCatalog
from sheath_manip.dashboard.markup import TEXT, caption, note
from sheath_manip.dashboard.player import Player
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.dataset.marks import Marks
from sheath_manip.types import Outcome

AS_RECORDED = "as recorded"
BEGIN, END, CLEAR = "begins here", "ends here", "clear all"


class Marking:
    """Marks the episode that is on, by its place: nothing from the page names a file."""

    def __init__(self, context: WidgetContext, catalog: EpisodeCatalog, player: Player) -> None:
        gui = context.viser.gui
        self._catalog, self._player = catalog, player
        self._begun: tuple[int, int] | None = None
        gui.add_html(caption("Marks", "kept beside the episode, which stays as it is"))
        self.outcome = gui.add_dropdown("Outcome", (AS_RECORDED, *map(str, Outcome)))
        self.bad = gui.add_button_group("Bad stretch", (BEGIN, END, CLEAR))
        self._said = gui.add_html("")

        @self.outcome.on_update
        async def _(event: viser.GuiEvent) -> None:
            if event.client_id is not None and context.allows(event.client_id):
                chosen = self.outcome.value
                outcome = None if chosen == AS_RECORDED else Outcome(chosen)
                self._mark(lambda marks: replace(marks, outcome=outcome))

        @self.bad.on_click
        async def _(event: viser.GuiEvent) -> None:
            if context.allows(event.client_id):
                self._press(self.bad.value)

    def draw(self, snapshot: Snapshot) -> None:  # noqa: ARG002
        """Show what has been said."""
        marks = self._catalog.kept(self._player.now.place)
        shown = AS_RECORDED if marks.outcome is None else str(marks.outcome)
        if self.outcome.value != shown:
            self.outcome.value = shown
        self._said.content = _said(marks, self._begun_here())

    def _begun_here(self) -> int | None:
        """Where a stretch was begun in this very episode."""
        begun = self._begun
        return begun[1] if begun is not None and begun[0] == self._player.now.place else None

    def _press(self, pressed: str) -> None:
        now = self._player.now
        if pressed == BEGIN:
            self._begun = now.place, now.at
        elif pressed == CLEAR:
            self._begun = None
            self._mark(lambda marks: replace(marks, bad=()))
        elif (begun := self._begun_here()) is not None:
            first, last = sorted((begun, now.at))
            self._begun = None
            self._mark(lambda marks: marks.with_bad(first, last + 1))
        else:
            self._player.do(lambda: self._player.say(f"press '{BEGIN}' first"), "")

    def _mark(self, change: Callable[[Marks], Marks]) -> None:
        place = self._player.now.place

        def work() -> None:
            self._catalog.mark(place, change(self._catalog.kept(place)))
            self._player.say("marked")

        self._player.do(work, "marking …")


def _said(marks: Marks, begun: int | None) -> str:
    # Counted from 1, as in all that the page says.
    noted = "".join(
        f'<div data-sheath-step="{each.step}">step {each.step + 1}: {escape(each.text)}</div>'
        for each in marks.notes
    )
    notes = f'<div style="{TEXT}"><b>Notes</b> (M){noted}</div>' if noted else note("M: a note")
    lines = [f"steps {start + 1} .. {stop}" for start, stop in marks.bad]
    if begun is not None:
        lines.append(f"from step {begun + 1} to … (go on, then '{END}')")
    if not lines:
        return notes + note("no bad stretch: all labels of the episode are learned from")
    return notes + f'<div style="{TEXT}">not learned from: {escape(", ".join(lines))}</div>'
