"""The few pieces of HTML that the page's texts are made of."""

from html import escape

BOX = "margin:0.4em 1em;padding:0.5em 0.9em;border-radius:6px;color:white;line-height:1.35"
TEXT = "margin:0.4em 1.1em;font-size:0.85em;font-variant-numeric:tabular-nums"


def caption(text: str, detail: str = "") -> str:
    """A heading with a fainter explanation; both are escaped."""
    return (
        f'<div style="{TEXT};margin-bottom:0"><b>{escape(text)}</b> '
        f'<span style="opacity:.6">{escape(detail)}</span></div>'
    )


def note(text: str) -> str:
    """A faint line; escaped."""
    return f'<div style="{TEXT};opacity:.6">{escape(text)}</div>'
