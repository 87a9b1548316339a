"""An explanation as HTML: figures of states, bars of signals, and actions side by side."""

import base64
from html import escape

import cv2
import numpy as np
from numpy.typing import NDArray

from sheath_manip.dashboard.action_words import quantity, same, wish
from sheath_manip.dashboard.explaining import Explanation, did
from sheath_manip.dashboard.markup import TEXT, coloured
from sheath_manip.dashboard.reference import stacked_views
from sheath_manip.playback import palette
from sheath_manip.types import Action, ActionSpec, Actor

POLICY, EXPERT = palette.css(palette.ACTOR[Actor.POLICY]), palette.css(palette.ACTOR[Actor.EXPERT])
ALARM = EXPERT
_FIGURE = "margin:0;flex:1;min-width:0;max-width:25%"
WIDTH, ROW, LEFT, MARGIN = 320, 18, 92, 8
"""of the chart of actions, in its own units"""


def sentence(explanation: Explanation) -> str:
    """Return why, in a sentence."""
    return f'<div style="{TEXT};font-weight:600">{escape(explanation.sentence)}</div>'


def figures(explanation: Explanation, spec: ActionSpec) -> str:
    """Return the present state and those like it, side by side, with what was done in each."""
    moment = explanation.moment
    wants = "nothing valid" if moment.proposed is None else did(spec, moment.proposed)
    now = stacked_views(list(moment.observation.images.values()))
    told = [f"<b>now</b><br>the policy wants: {escape(wants)}"]
    shown = [_figure(now, told[0], POLICY)]
    for place, example in enumerate(explanation.examples, 1):
        text = f"<b>like it, {place}</b><br>the expert: {escape(example.did)}"
        away = f'<br><span style="opacity:.75">distance {example.distance:.2f}</span>'
        shown.append(_figure(example.image, text + away, EXPERT))
    lacks = f"<div>{escape(explanation.lacks)}</div>" if explanation.lacks else ""
    row = f'<div style="display:flex;gap:6px;align-items:flex-start">{"".join(shown)}</div>'
    return f'<div style="{TEXT};line-height:1.25">{row}{lacks}</div>'


def signals(explanation: Explanation) -> str:
    """Return a bar of each signal: the share of held-out expert steps that score lower."""
    rows = "".join(
        f'<tr style="{"font-weight:600" if each.signal == explanation.rang else ""}">'
        f"<td>{escape(each.signal)}</td><td>{each.score:.3g}</td>"
        f'<td style="width:45%">{_bar(each.share, each.signal == explanation.rang)}</td>'
        f"<td>{'not known' if np.isnan(each.share) else f'{each.share:.1%}'}</td></tr>"
        for each in explanation.moment.decision.signals
    )
    if not rows:
        return f'<div style="{TEXT}">This gate does not say what its score is made of.</div>'
    return (
        f'<div style="{TEXT}"><table style="width:100%;text-align:right;border-spacing:4px 2px">'
        '<tr style="opacity:.75"><td>signal</td><td>score</td>'
        '<td colspan="2">expert steps that score lower</td></tr>'
        f"{rows}</table></div>"
    )


def actions(explanation: Explanation, spec: ActionSpec) -> str:
    """Return what policy and expert want, among what was done in the states most like this one."""
    precedents, moment = explanation.precedents, explanation.moment
    proposed = moment.proposed
    labels, labelled = None, moment.labelled
    if precedents is not None:
        # In the frame of the policy's own, where it has one; the expert's answer is not.
        moved = proposed is None or not np.allclose(precedents.proposed, proposed, atol=1e-6)
        labels, proposed = precedents.labels, precedents.proposed
        labelled = None if moved else labelled
    drawn = _choices if spec.choices is not None else _numbers
    count = 0 if labels is None else len(labels)
    among = f", grey the {count} expert steps in the states most like it" * bool(count)
    other = palette.ACTOR[moment.other]
    expert = f", {coloured('◆', other)} {moment.other.value}" * (labelled is not None)
    legend = f"{coloured('●', palette.ACTOR[Actor.POLICY])} policy{expert}{among}"
    return f'<div style="{TEXT}">{drawn(spec, labels, proposed, labelled, other)}{legend}</div>'


def _figure(image: NDArray[np.uint8] | None, caption: str, colour: str) -> str:
    picture = '<div style="height:40px;background:#80808030"></div>'
    if image is not None:
        # viser's page takes RGB, OpenCV writes BGR.
        _, png = cv2.imencode(".png", image[..., ::-1])
        source = f"data:image/png;base64,{base64.b64encode(png.tobytes()).decode()}"
        picture = (
            f'<img src="{source}" alt="what the cameras saw" '
            'style="width:100%;image-rendering:pixelated;display:block">'
        )
    return (
        f'<figure style="{_FIGURE};border-top:4px solid {colour}">{picture}'
        f'<figcaption style="font-size:.9em;overflow-wrap:anywhere">{caption}</figcaption></figure>'
    )


def _bar(share: float, alarms: bool) -> str:
    width = 0.0 if np.isnan(share) else 100 * share
    colour = ALARM if alarms else palette.css(palette.GREY)
    return (
        '<div style="background:#80808030;height:.8em">'
        f'<div style="width:{width:.1f}%;min-width:2px;height:100%;background:{colour}">'
        "</div></div>"
    )


def _choices(
    spec: ActionSpec,
    labels: NDArray | None,
    proposed: Action | None,
    labelled: Action | None,
    other: palette.Rgb,
) -> str:
    assert spec.choices is not None
    rows = []
    for at, choice in enumerate(spec.choices):
        share = 0.0 if labels is None else float(same(spec, labels, choice).mean())
        wanted = [
            (proposed, coloured("●", palette.ACTOR[Actor.POLICY])),
            (labelled, coloured("◆", other)),
        ]
        marks = "".join(
            mark for each, mark in wanted if each is not None and same(spec, choice[None], each)[0]
        )
        if share or marks:
            rows.append(
                f'<tr><td style="white-space:nowrap">{marks} {escape(wish(spec, spec.choices[at]))}'
                f'</td><td style="width:50%">{_bar(share, False)}</td><td>{share:.0%}</td></tr>'
            )
    return f'<table style="width:100%;text-align:right">{"".join(rows)}</table>'


def _numbers(
    spec: ActionSpec,
    labels: NDArray | None,
    proposed: Action | None,
    labelled: Action | None,
    other: palette.Rgb,
) -> str:
    def across(at: int, value: float) -> float:
        share = (value - spec.minimum[at]) / spec.span[at]
        return LEFT + float(np.clip(share, 0, 1)) * (WIDTH - LEFT - MARGIN)

    pieces = []
    for at, name in enumerate(spec.names):
        middle = ROW * at + ROW / 2
        pieces.append(
            f'<text x="{LEFT - 6}" y="{middle + 3.5}" text-anchor="end">'
            f"{escape(quantity(name)[0])}</text>"
            f'<line x1="{LEFT}" x2="{WIDTH - MARGIN}" y1="{middle}" y2="{middle}" '
            'stroke="currentColor" opacity=".25"/>'
        )
        if labels is not None:
            low, high = (across(at, each) for each in np.quantile(labels[:, at], (0.05, 0.95)))
            pieces.append(
                f'<rect x="{low:.1f}" y="{middle - 5}" width="{max(high - low, 1.5):.1f}" '
                'height="10" fill="#808080" opacity=".55"/>'
            )
        if labelled is not None:
            x = across(at, float(labelled[at]))
            points = f"{x - 5},{middle} {x},{middle - 5} {x + 5},{middle} {x},{middle + 5}"
            pieces.append(f'<polygon points="{points}" fill="{palette.css(other)}"/>')
        if proposed is not None:
            x = across(at, float(proposed[at]))
            pieces.append(f'<circle cx="{x:.1f}" cy="{middle}" r="4" fill="{POLICY}"/>')
    height = ROW * len(spec.names)
    return (
        f'<svg viewBox="0 0 {WIDTH} {height}" style="width:100%" font-size="10" '
        f'fill="currentColor">{"".join(pieces)}</svg>'
    )
