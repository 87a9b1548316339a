"""The interventions of the shown episode, as a list that one can jump to."""

from collections.abc import Callable

import viser

from sheath_manip.dashboard.changed import set_changed
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.playback.trace import Trace
from sheath_manip.types import REASONS

NONE: str = "none yet"
LISTED = 100
"""the latest: a list of more nobody reads"""


class Interventions:
    """A list, buttons to the one before and after, and the way back to the present."""

    def __init__(
        self,
        context: WidgetContext,
        look_at: Callable[[int], None],
        release: Callable[[], None] | None = None,
    ) -> None:
        """`look_at` shows a step, `release` the present; what is recorded has none."""
        gui = context.viser.gui
        self._look_at = look_at
        self._starts: list[int] = []
        self._at = -1
        self._options: tuple[str, ...] = (NONE,)
        self._list = gui.add_dropdown(
            "Interventions", self._options, hint="choose one to look at it"
        )
        self._move = gui.add_button_group("Jump", ("‹ before", "next ›"))
        self._back = gui.add_button(
            "Back to the present", icon=viser.Icon.PLAYER_TRACK_NEXT, visible=False
        )
        self._has_present = release is not None

        @self._list.on_update
        async def _(event: viser.GuiEvent[viser.GuiDropdownHandle[str]]) -> None:
            # What this widget sets itself has no client.
            if event.client_id is not None and self._list.value in self._options:
                place = self._options.index(self._list.value)
                if place < len(self._starts):
                    look_at(self._starts[place])

        @self._move.on_click
        async def _(_: viser.GuiEvent[viser.GuiButtonGroupHandle]) -> None:
            self._jump(forward=self._move.value == "next ›")

        @self._back.on_click
        async def _(_: viser.GuiEvent[viser.GuiButtonHandle]) -> None:
            if release is not None:
                release()

    def draw(self, snapshot: Snapshot) -> None:
        """List what the shown episode has."""
        turns = list(enumerate(snapshot.trace.turns, 1))[-LISTED:]
        self._starts = [start for _, (start, _) in turns]
        self._at = snapshot.at
        options = tuple(_line(number, snapshot.trace, *turn) for number, turn in turns) or (NONE,)
        if options != self._options:
            self._list.options = self._options = options
        # The one under way, or the last before.
        shown = options[max(0, sum(start <= snapshot.at for start in self._starts) - 1)]
        if self._list.value != shown:
            self._list.value = shown
        set_changed(self._back, visible=self._has_present and not snapshot.present)

    def _jump(self, forward: bool) -> None:
        if forward:
            later = [start for start in self._starts if start > self._at]
            if later:
                self._look_at(later[0])
        else:
            earlier = [start for start in self._starts if start < self._at]
            if earlier:
                self._look_at(earlier[-1])


def _line(number: int, trace: Trace, start: int, stop: int) -> str:
    """Begins with its number, so that no two are alike; one that may still grow has no length."""
    reason = REASONS[trace.reason[start]].value
    steps = stop - start
    length = f" · {steps} step{'s' * (steps != 1)}" if stop < len(trace) else ""
    return f"{number} · {trace.time_s[start]:.1f} s · {reason}{length}"
