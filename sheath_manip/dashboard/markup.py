"""The few pieces of HTML that the page's texts are made of."""

from html import escape

from sheath_manip.playback import palette

BOX = "margin:0.4em 1em;padding:0.5em 0.9em;border-radius:6px;color:white;line-height:1.35"
GREY_BUTTON = (92, 98, 106)
"""on which white letters have a contrast of 6 to 1; on viser's own grey it is 3.3"""
TEXT = "margin:0.4em 1.1em;font-size:0.85em;font-variant-numeric:tabular-nums"


def coloured(mark: str, colour: palette.Rgb) -> str:
    """A mark in a colour, for before a word: letters in the colours of actors are hard to read."""
    return f'<span style="color:{palette.css(colour)}">{mark}</span>'


def caption(text: str, detail: str = "") -> str:
    """A heading with a fainter explanation; both are escaped."""
    return (
        f'<div style="{TEXT};margin-bottom:0"><b>{escape(text)}</b> '
        f'<span style="opacity:.6">{escape(detail)}</span></div>'
    )


def note(text: str) -> str:
    """A faint line; escaped."""
    return f'<div style="{TEXT};opacity:.6">{escape(text)}</div>'
