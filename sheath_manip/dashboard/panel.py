"""The panel beside the scene: who acts and why, counts, pause, score, support, cameras."""

from collections.abc import Callable, Mapping, Sequence
from html import escape

import numpy as np
import viser
from numpy.typing import NDArray
from viser.uplot import Axis

from sheath_manip.dashboard import palette
from sheath_manip.dashboard.tally import HISTORY_STEPS, Figures, Scored, Share
from sheath_manip.support.plane import NUS
from sheath_manip.types import Actor, GateDecision, Outcome, TaskSpec

SCORE_PLOT_HEIGHT_PX = 140
PLOT_FONT = "12px sans-serif"
PLOT_AXIS = Axis(
    font=PLOT_FONT,
    labelFont=PLOT_FONT,
    stroke=palette.css(palette.GREY),
    ticks={"show": False},
)
LIMITED_BAND = 0.06
"""of the plot's height, along its lower edge"""
CAMERA_WIDTH_PX = 220
CAMERA_MARGIN_PX = 15
NO_PLANE = "This task has no natural plane to draw its support in."
NO_TRAINING = "The support appears here with the first training states."


class Panel:
    """The elements of the panel; every name that comes from data is escaped."""

    def __init__(
        self, server: viser.ViserServer, spec: TaskSpec, on_pause: Callable[[], bool]
    ) -> None:
        """`on_pause` is called when the button is pressed, and says if the run is paused now."""
        self._spec = spec
        gui = server.gui
        self._trouble = gui.add_html("", visible=False)
        self._banner = gui.add_html(_banner(None, None))
        self._facts = gui.add_html("")
        self._limited = gui.add_html("", visible=False)
        self._counts = gui.add_html("")
        self._pause = gui.add_button("Pause", icon=viser.Icon.PLAYER_PAUSE, color="gray")

        @self._pause.on_click
        async def _(_: viser.GuiEvent[viser.GuiButtonHandle]) -> None:
            self.show_paused(on_pause())

        window_s = min(HISTORY_STEPS, spec.max_steps) / spec.control_rate_hz
        gui.add_html(_caption("Support score", "threshold dashed, expert's turns shaded"))
        self._no_score = gui.add_html(_note("This gate computes no score."))
        self._scores = gui.add_uplot(
            (np.zeros(1),) * len(Scored._fields),
            (
                {"label": "seconds from now"},
                {"label": "score", "stroke": palette.css(palette.INK), "width": 2},
                {
                    "label": "threshold",
                    "stroke": palette.css(palette.GREY),
                    "width": 1.5,
                    "dash": (6, 4),
                },
                {
                    "label": "expert acts",
                    "scale": "expert",
                    "fill": palette.css(palette.ACTOR[Actor.EXPERT]) + "50",
                    "width": 0,
                    "points": {"show": False},
                },
                {
                    "label": "command limited",
                    "scale": "expert",
                    "fill": palette.css(palette.LIMITED),
                    "width": 0,
                    "points": {"show": False},
                },
            ),
            # Ranges that stand still; one that follows the data viser's page now and then loses.
            scales={
                "x": {"time": False, "range": (-window_s, 0.0)},
                "expert": {"range": (0.0, 1.0)},
            },
            axes=(
                PLOT_AXIS | Axis(size=28, label="seconds from now", labelSize=18),
                PLOT_AXIS | Axis(size=44),
            ),
            legend={"show": False},
            height=SCORE_PLOT_HEIGHT_PX,
            visible=False,
        )
        gui.add_html(_caption("Support", _plane(spec)))
        blank = np.zeros((1, 1, 3), np.uint8)
        self._support = gui.add_image(blank, jpeg_quality=85, visible=False)
        self._support_note = gui.add_html(_note(NO_TRAINING if spec.plane else NO_PLANE))
        self._cameras: dict[str, viser.GuiImageHandle] = {}
        if spec.cameras:
            window = gui.add_panel()
            with window.add_tab("What the policy sees"):
                for name in spec.cameras:
                    label = name if len(spec.cameras) > 1 else None
                    self._cameras[name] = gui.add_image(
                        blank, label=label, jpeg_quality=85, visible=False
                    )
            window.float(x=CAMERA_MARGIN_PX, y=CAMERA_MARGIN_PX, width=CAMERA_WIDTH_PX)

    def show_figures(self, figures: Figures) -> None:
        """Show who acts, in which episode, and the counts so far."""
        self._banner.content = _banner(figures.decision, figures.outcome)
        self._facts.content = _facts(figures, self._spec)
        self._counts.content = _counts(figures)
        # The text first: an empty box would be seen for a moment otherwise.
        self._limited.content = _limited(figures)
        self._limited.visible = figures.series.limited_steps > 0

    def show_scores(self, scores: Sequence[Scored]) -> None:
        """Plot the latest steps."""
        columns = np.asarray(scores, dtype=np.float64).reshape(-1, len(Scored._fields)).T
        scored = bool(np.isfinite(columns[1]).any())
        self._scores.visible, self._no_score.visible = scored, not scored
        if scored:
            columns[0] -= columns[0, -1]
            columns[Scored._fields.index("limited")] *= LIMITED_BAND
            self._scores.data = tuple(np.ascontiguousarray(column) for column in columns)

    def show_support(self, picture: NDArray[np.uint8], trained: bool) -> None:
        """Show the (h, w, 3) RGB support picture, of a policy that is `trained` or not yet."""
        self._support.image = picture
        self._support.visible = True
        self._support_note.content = _support_legend() if trained else _note(NO_TRAINING)

    def show_cameras(self, images: Mapping[str, NDArray[np.uint8]]) -> None:
        """Show the (h, w, 3) RGB images by camera."""
        for name, image in images.items():
            if name in self._cameras:
                self._cameras[name].image = _enlarged(image)
                self._cameras[name].visible = True

    def show_paused(self, paused: bool) -> None:
        """Make the button offer the other of pausing and resuming."""
        self._pause.label = "Resume" if paused else "Pause"
        self._pause.icon = viser.Icon.PLAYER_PLAY if paused else viser.Icon.PLAYER_PAUSE
        self._pause.color = "green" if paused else "gray"

    def show_trouble(self, failure: str) -> None:
        """Say that what is shown is out of date, or with an empty text that it is not."""
        # The text first: an empty box would be seen for a moment otherwise.
        if failure:
            self._trouble.content = (
                f'<div style="{_BOX};background:{palette.css(palette.OUTCOME[Outcome.FAILURE])}">'
                f"<b>This page is out of date.</b><br>{escape(failure)}</div>"
            )
        self._trouble.visible = bool(failure)


def _enlarged(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """A policy's small image with every pixel repeated: the page shows images as they are."""
    times = -(-CAMERA_WIDTH_PX // image.shape[1])
    return image.repeat(times, 0).repeat(times, 1)


_BOX = "margin:0.4em 1em;padding:0.5em 0.9em;border-radius:6px;color:white;line-height:1.35"


def _banner(decision: GateDecision | None, outcome: Outcome | None) -> str:
    if decision is None:
        colour, title, below = palette.GREY, "Waiting", "for the first step"
    else:
        colour, title = palette.ACTOR[decision.actor], f"{decision.actor.value.capitalize()} acts"
        below = decision.reason.value
        if np.isfinite(decision.score):
            below += f" · score {decision.score:+.3f}"
        if np.isfinite(decision.threshold):
            below += f" · threshold {decision.threshold:+.3f}"
    if outcome is not None:
        colour, title, below = palette.OUTCOME[outcome], outcome.value.capitalize(), "episode over"
    return (
        f'<div style="{_BOX};background:{palette.css(colour)}">'
        f'<div style="font-size:1.7em;font-weight:700">{escape(title)}</div>{escape(below)}</div>'
    )


def _facts(figures: Figures, spec: TaskSpec) -> str:
    info = figures.info
    where = (info.method, info.purpose.value, f"round {info.round}", f"episode {info.index}")
    now = f"step {figures.episode.steps} of {spec.max_steps}"
    return (
        f'<div style="{_TEXT}">{escape(" · ".join(filter(None, where)))}<br>{now}'
        f'<span style="opacity:.6"> · scene {info.seed}</span></div>'
    )


def _limited(figures: Figures) -> str:
    """What the command filter did to the latest step, and how often it did anything."""
    now = " · ".join(f"{escape(each.limit)} {each.by:.0%}" for each in figures.limited)
    counted = " · ".join(
        f"{share.limited_share:.0%} of {name}"
        for name, share in (("this episode", figures.episode), ("all", figures.series))
    )
    colour = palette.css(palette.LIMITED) if now else "transparent"
    return (
        f'<div style="{_TEXT};border-left:4px solid {colour};padding-left:.5em">'
        f"<b>Command limited</b> {now or 'not now'}<br>"
        f'<span style="opacity:.6">{counted}</span></div>'
    )


def _counts(figures: Figures) -> str:
    def row(name: str, share: Share) -> str:
        return (
            f'<tr><td style="opacity:.6;text-align:left">{name}</td><td>{share.interventions}</td>'
            f"<td>{share.expert_share:.0%}</td><td>{share.steps}</td></tr>"
        )

    info = figures.info
    series = " ".join(filter(None, (info.method, info.purpose.value)))
    outcomes = figures.outcomes or {}
    ended = " &nbsp; ".join(
        f'<span style="color:{palette.css(palette.OUTCOME[outcome])}">'
        f"<b>{outcomes.get(outcome, 0)}</b> {escape(outcome.value)}</span>"
        for outcome in Outcome
    )
    return (
        f'<div style="{_TEXT}"><table style="width:100%;text-align:right">'
        '<tr style="opacity:.6"><td></td><td>interventions</td><td>expert</td><td>steps</td></tr>'
        f"{row('this episode', figures.episode)}{row(f'all {escape(series)}', figures.series)}"
        f'</table><div style="margin-top:0.3em">{ended}</div></div>'
    )


_TEXT = "margin:0.4em 1.1em;font-size:0.85em;font-variant-numeric:tabular-nums"


def _plane(spec: TaskSpec) -> str:
    """The plane's features without the unit that ends their names."""
    if spec.plane is None:
        return ""
    x, y = (name.removesuffix("_m") for name in spec.plane)
    return f"over {x} and {y} (m)"


def _support_legend() -> str:
    nus = ", ".join(map(str, NUS))
    trail = " and ".join(
        f'<b style="color:{palette.css(palette.ACTOR[actor])}">{actor.value}</b>' for actor in Actor
    )
    return (
        f'<div style="{_TEXT}">trail of {trail} <span style="opacity:.6">· dots: training states · '
        f"yellow: support at ν = {nus}</span></div>"
    )


def _caption(text: str, detail: str) -> str:
    return (
        f'<div style="{_TEXT};margin-bottom:0"><b>{escape(text)}</b> '
        f'<span style="opacity:.6">{escape(detail)}</span></div>'
    )


def _note(text: str) -> str:
    return f'<div style="{_TEXT};opacity:.6">{escape(text)}</div>'
