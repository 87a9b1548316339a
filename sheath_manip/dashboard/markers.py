"""The markers of methods as SVG text, in the shapes of the figures: one need see no colours."""

from math import cos, radians, sin

from sheath_manip.playback import palette
from sheath_manip.playback.palette import Look

_CORNERS: dict[str, tuple[int, float, float]] = {
    "o": (18, 0, 1),
    "s": (4, 45, 1),
    "D": (4, 0, 1),
    "d": (4, 0, 1),
    "^": (3, 0, 1),
    ">": (3, 90, 1),
    "v": (3, 180, 1),
    "<": (3, 270, 1),
    "p": (5, 0, 1),
    "h": (6, 0, 1),
    "P": (4, 0, 0.38),
    "X": (4, 45, 0.38),
    "*": (5, 0, 0.42),
}
"""by matplotlib's letter: corners, how far the first one is turned from the top in degrees, and how
far from the middle what lies between two of them is; 1: nothing lies between"""
NARROW = "d"


def tone(look: Look) -> str:
    """Return the attributes of what is drawn in the colour of `look`, as `currentColor`.

    The page's script lightens it where the page is dark; ink is the colour of the page's own text.
    """
    own = "currentColor" if look.rgb == palette.INK else palette.css(look.rgb)
    return f'data-sheath-tone style="--own:{own};color:var(--own)"'


def marker(look: Look, x: float, y: float, radius: float) -> str:
    """Return the marker of `look` around that place."""
    corners, turned_deg, waist = _CORNERS.get(look.marker, _CORNERS["o"])
    radii = (radius,) if waist == 1 else (radius, waist * radius)
    count = corners * len(radii)
    width = 0.6 if look.marker == NARROW else 1.0
    places = []
    for number in range(count):
        angle, away = radians(turned_deg + 360 * number / count), radii[number % len(radii)]
        places.append(f"{x + width * away * sin(angle):.1f},{y - away * cos(angle):.1f}")
    return f'<polygon points="{" ".join(places)}" fill="currentColor"/>'


def dashes(look: Look, width: float) -> str:
    """Return the dashes of `look` in a line of that width, as an attribute says them."""
    return " ".join(f"{width * each:g}" for each in look.dashes) or "none"


def sample(look: Look) -> str:
    """Return a short piece of a line with its marker, as a legend has it."""
    line = (
        '<line x1="0" x2="26" y1="5" y2="5" stroke="currentColor" stroke-width="2" '
        f'stroke-dasharray="{dashes(look, 2)}"/>'
    )
    return (
        '<svg viewBox="0 0 26 10" aria-hidden="true" '
        'style="width:2.1em;height:.8em;vertical-align:baseline">'
        f"<g {tone(look)}>{line}{marker(look, 13, 5, 4.5)}</g></svg>"
    )
