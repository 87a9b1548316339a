"""One colour for each meaning, the same in the panel, the score plot and the support picture."""

from sheath_manip.types import Actor, Outcome

Rgb = tuple[int, int, int]

# Blue, vermillion, purple and yellow of Okabe and Ito, which colour-blind readers can tell apart.
ACTOR: dict[Actor, Rgb] = {Actor.POLICY: (0, 114, 178), Actor.EXPERT: (213, 94, 0)}
OUTCOME: dict[Outcome, Rgb] = {
    Outcome.SUCCESS: (0, 135, 100),
    Outcome.FAILURE: (190, 30, 45),
    Outcome.TIME_LIMIT: (110, 116, 124),
}
LIMITED: Rgb = (204, 121, 167)
SUPPORT: Rgb = (240, 228, 66)
INK: Rgb = (34, 39, 46)
GREY: Rgb = (110, 116, 124)


def css(rgb: Rgb) -> str:
    """`rgb` as a page writes it."""
    return f"#{rgb[0]:02x}{rgb[1]:02x}{rgb[2]:02x}"
