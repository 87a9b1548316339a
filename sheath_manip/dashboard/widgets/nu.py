"""A slider of nu: the support is fitted anew while the run goes on."""

import threading
from collections.abc import Callable
from dataclasses import replace

import viser

from sheath_manip.dashboard.markup import note
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.gates.adjustable import Boundary, Dial

LEAST_NU, MOST_NU = 0.005, 0.6
FITTING = "fitting the support with ν = {nu:g} …"

Refit = Callable[[float], Boundary]
"""from nu to the boundary of the support that is fitted anew; takes seconds"""


class NuSlider:
    """A worker fits the support anew; until it is done the old one decides."""

    def __init__(self, context: WidgetContext, dial: Dial, refit: Refit, nu: float) -> None:
        gui = context.viser.gui
        self._dial, self._refit, self._wake = dial, refit, context.wake
        self._wanted: float | None = None
        self._told = ""
        self._news = threading.Condition()
        self.slider = gui.add_slider(
            "ν",
            min=min(LEAST_NU, nu),
            max=max(MOST_NU, nu),
            step=LEAST_NU,
            initial_value=nu,
        )
        self._note = gui.add_html(_note(nu, ""))
        self._nu = nu
        threading.Thread(target=self._work, name="support refit", daemon=True).start()

        @self.slider.on_update
        async def _(event: viser.GuiEvent) -> None:
            if event.client_id is not None and context.allows(event.client_id):
                with self._news:
                    self._wanted = float(self.slider.value)
                    self._news.notify()

    def draw(self, snapshot: Snapshot) -> None:
        """Tell how far the worker is."""
        del snapshot
        self._note.content = _note(self._nu, self._told)

    def _work(self) -> None:
        while True:
            with self._news:
                while self._wanted is None:
                    self._news.wait()
                # What was asked for in between is skipped: only the last wish counts.
                nu, self._wanted = self._wanted, None
            self._told = FITTING.format(nu=nu)
            self._wake()
            try:
                refitted = self._refit(nu)
                kept = self._dial.boundary.minimum_hold_steps
                self._dial.boundary = replace(refitted, minimum_hold_steps=kept)
                self._nu, self._told = nu, ""
            except Exception as error:
                # Of a worker nobody else would hear.
                self._told = f"ν stays: {type(error).__name__}: {error}"
            self._wake()


def _note(nu: float, told: str) -> str:
    return note(told or f"ν = {nu:g}: at most that share of the training states lies outside")
