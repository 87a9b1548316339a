"""Sliders that move the gate's boundary: its threshold, and nu of its support."""

import math
import threading
from collections.abc import Callable

import viser

from sheath_manip.dashboard.markup import caption, note
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.gates.adjustable import Boundary, Dial

LEAST_STEPS = 100
LEAST_NU, MOST_NU = 0.005, 0.6
FITTING = "fitting the support with ν = {nu:g} …"

Refit = Callable[[float], Boundary]
"""from nu to the boundary of the support that is fitted anew; takes seconds"""


class ThresholdSlider:
    """The gate goes by it from its next step on."""

    def __init__(self, context: WidgetContext, dial: Dial) -> None:
        gui, boundary = context.viser.gui, dial.boundary
        self._dial = dial
        self._shown = boundary
        gui.add_html(caption("Gate", "takes effect at the next step"))
        self.slider = gui.add_slider(
            "Threshold",
            min=boundary.lowest,
            max=boundary.highest,
            step=_step(boundary),
            initial_value=boundary.threshold,
        )
        self._span(boundary)

        @self.slider.on_update
        async def _(event: viser.GuiEvent) -> None:
            # An update without a client is the program's own.
            if event.client_id is not None and context.allows(event.client_id):
                dial.boundary = dial.boundary.at(float(self.slider.value))
                self._shown = dial.boundary
            context.wake()

    def draw(self, snapshot: Snapshot) -> None:
        """Follow what a new fit, or who may, has made of it."""
        del snapshot
        boundary = self._dial.boundary
        if boundary is self._shown and self.slider.value == boundary.threshold:
            return
        self._span(boundary)
        self.slider.value = boundary.threshold
        self._shown = boundary

    def _span(self, boundary: Boundary) -> None:
        """Begin and end on round numbers, around all that the boundary allows."""
        step = _step(boundary)
        digits = max(0, -math.floor(math.log10(step)))
        self.slider.step, self.slider.precision = step, digits
        self.slider.min = round(step * math.floor(boundary.lowest / step), digits)
        self.slider.max = round(step * math.ceil(boundary.highest / step), digits)


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
                self._dial.boundary = self._refit(nu)
                self._nu, self._told = nu, ""
            except Exception as error:
                # Of a worker nobody else would hear.
                self._told = f"ν stays: {type(error).__name__}: {error}"
            self._wake()


def _step(boundary: Boundary) -> float:
    """A power of ten: some hundred of them from end to end."""
    return 10.0 ** math.floor(math.log10((boundary.highest - boundary.lowest) / LEAST_STEPS))


def _note(nu: float, told: str) -> str:
    return note(told or f"ν = {nu:g}: at most that share of the training states lies outside")
