"""The episodes of the store, to choose from."""

from html import escape

import viser

from sheath_manip.dashboard.catalog import EpisodeCatalog
from sheath_manip.dashboard.markup import TEXT, coloured
from sheath_manip.dashboard.player import Player
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.dataset.reader import EpisodeSummary
from sheath_manip.playback import palette

AROUND = 12
"""rows of the table before and after the one that is on"""
_LEFT = "text-align:left;padding-left:.6em"


class EpisodeList:
    """A list to choose from, and a table of what lies around."""

    def __init__(self, context: WidgetContext, catalog: EpisodeCatalog, player: Player) -> None:
        gui = context.viser.gui
        self._catalog = catalog
        self._player = player
        self._summaries: list[EpisodeSummary] = catalog.summaries
        self._lines = [_line(*each) for each in enumerate(self._summaries)]
        self.choice = gui.add_dropdown("Episode", tuple(self._lines))
        self.move = gui.add_button_group("Another one", ("‹ before", "next ›"))
        self._table = gui.add_html("")

        @self.choice.on_update
        async def _(event: viser.GuiEvent) -> None:
            if event.client_id is not None and self.choice.value in self._lines:
                player.load(self._lines.index(self.choice.value))

        @self.move.on_click
        async def _(_: viser.GuiEvent) -> None:
            forward = self.move.value == "next ›"
            player.load((player.now.place + (1 if forward else -1)) % len(catalog))

    def draw(self, snapshot: Snapshot) -> None:  # noqa: ARG002
        """Show which one is on, and what was marked since."""
        place, summaries = self._player.now.place, self._catalog.summaries
        if summaries != self._summaries:
            self._summaries = summaries
            self._lines = [_line(*each) for each in enumerate(summaries)]
            self.choice.options = tuple(self._lines)
        if self.choice.value != self._lines[place]:
            self.choice.value = self._lines[place]
        first = max(0, min(place - AROUND, len(summaries) - 2 * AROUND - 1))
        shown = list(enumerate(summaries))[first : first + 2 * AROUND + 1]
        self._table.content = _table(shown, place, len(summaries))


def _line(place: int, summary: EpisodeSummary) -> str:
    """Begins with its place, so that no two are alike."""
    info = summary.info
    where = " ".join(filter(None, (info.method, info.purpose.value)))
    return (
        f"{place} · {where} r{info.round} · {summary.outcome.value} "
        f"· expert {summary.expert_share:.0%}"
    )


def _table(shown: list[tuple[int, EpisodeSummary]], place: int, count: int) -> str:
    rows = "".join(_row(number, summary, number == place) for number, summary in shown)
    return (
        f'<div style="{TEXT}"><table style="width:100%;border-collapse:collapse;text-align:right">'
        f'<tr style="opacity:.6"><td></td><td style="{_LEFT}">who</td>'
        "<td>round</td><td>steps</td><td>expert</td><td>outcome</td></tr>"
        f'{rows}</table><span style="opacity:.6">{count} episode{"s" * (count != 1)} · '
        "* marked by a person</span></div>"
    )


def _row(number: int, summary: EpisodeSummary, is_on: bool) -> str:
    info = summary.info
    who = escape(" ".join(filter(None, (info.method, info.purpose.value))))
    marked = summary.outcome is not summary.recorded_outcome or summary.bad_steps > 0
    colour = palette.OUTCOME[summary.outcome]
    background = "background:#80808030;font-weight:600" if is_on else ""
    return (
        f'<tr data-sheath-episode="{number}" style="{background}">'
        f'<td>{number}</td><td style="{_LEFT}">{who}</td>'
        f"<td>{info.round}</td><td>{summary.length}</td><td>{summary.expert_share:.0%}</td>"
        f"<td>{coloured('■', colour)} {escape(summary.outcome.value)}{'*' * marked}</td></tr>"
    )
