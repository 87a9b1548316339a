"""One HTML file with video, timeline, score and interventions: no network, nothing beside it."""

import base64
import json
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.naming import episode_name
from sheath_manip.playback import palette
from sheath_manip.playback.film import Film
from sheath_manip.playback.labels import actor_and_reason_label
from sheath_manip.playback.trace import Trace
from sheath_manip.types import REASONS

TEMPLATE = Path(__file__).with_name("page.html")


def html(film: Film, video: bytes) -> str:
    """The page of `film`, whose mp4 is `video`."""
    trace = film.trace.so_far()
    template = TEMPLATE.read_text("utf-8")
    # In a script only "<" could end it early; escaped it is the same text to JSON.
    facts = json.dumps(_facts(film, trace), allow_nan=False).replace("<", "\\u003c")
    parts = {
        "@TITLE@": escape(f"{film.info.task}: {episode_name(film.info)}"),
        "@FACTS@": facts,
        "@VIDEO@": base64.b64encode(video).decode(),
    }
    for mark, text in parts.items():
        template = template.replace(mark, text)
    return template


def _facts(film: Film, trace: Trace) -> dict[str, object]:
    whys = [trace.who_and_why(step) for step in range(len(trace))]
    colours = [palette.css(palette.turn(*why)) for why in whys]
    kinds = list(dict.fromkeys(colours))
    legend = {
        colour: actor_and_reason_label(*why) for colour, why in zip(colours, whys, strict=True)
    }
    return {
        "task": film.info.task,
        "name": episode_name(film.info),
        "rate_hz": film.info.control_rate_hz,
        "outcome": "" if film.outcome is None else film.outcome.value,
        "colours": kinds,
        "legend": [legend[colour] for colour in kinds],
        "kind": [kinds.index(colour) for colour in colours],
        "score": _numbers(trace.score),
        "threshold": _numbers(trace.threshold),
        "limited": np.flatnonzero(trace.limited).tolist(),
        "turns": [
            {"start": start, "stop": stop, "why": REASONS[trace.reason[start]].value}
            for start, stop in trace.turns
        ],
    }


def _numbers(values: NDArray[np.float64]) -> list[float | None]:
    """To four digits, with null for what is no number."""
    return [float(f"{value:.4g}") if np.isfinite(value) else None for value in values]
