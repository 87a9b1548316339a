"""What an experiment is at: method, training seed and round, how far it is, and the time left."""

from html import escape

from sheath_manip.dashboard.changed import set_changed
from sheath_manip.dashboard.markup import TEXT
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.learning.headway import left_words
from sheath_manip.learning.results import EXPERT
from sheath_manip.playback.written import shown
from sheath_manip.types import EpisodeInfo
from sheath_manip.types.work import Headway


class NowRunning:
    """Two lines above the curves; nothing where no run says how far it is."""

    def __init__(self, context: WidgetContext) -> None:
        self._html = context.viser.gui.add_html("", visible=False)

    def draw(self, snapshot: Snapshot) -> None:
        """Show what runs now."""
        headway = snapshot.headway
        set_changed(self._html, visible=headway is not None)
        if headway is not None:
            set_changed(self._html, content=_markup(snapshot.info, snapshot.work, headway))


def _markup(info: EpisodeInfo, work: str, headway: Headway) -> str:
    over = headway.done >= headway.units
    first = "All rounds are done" if over else running_words(info, work)
    share = headway.done / max(headway.units, 1)
    far = f"{headway.done:,} of {headway.units:,} episodes and fits"
    below = " · ".join(filter(None, (far, left_words(headway))))
    return (
        f'<div style="{TEXT};padding-bottom:.2em"><b>{escape(first)}</b><br>{escape(below)}'
        '<div style="height:4px;margin-top:.3em;border-radius:2px;background:#80808040">'
        f'<div style="height:100%;width:{100 * share:.1f}%;border-radius:2px;'
        'background:currentColor;opacity:.6"></div></div></div>'
    )


def running_words(info: EpisodeInfo, work: str) -> str:
    """Return such as "DAgger, training seed 1, round 3: fitting round 3"."""
    seed = f"training seed {info.run_seed}"
    if info.method == EXPERT:
        where = f"Demonstrations, {seed}"
    else:
        where = f"{shown(info.method)}, {seed}, round {info.round}"
    return f"{where}: {work}" if work else where
