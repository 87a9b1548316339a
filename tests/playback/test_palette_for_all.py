"""The palettes as colour-blind eyes see them, computed: Machado, Oliveira and Fernandes (2009).

Their matrices for a complete lack of the long or the middle cones, on linear light; distances are
Euclidean in CIELAB (CIE 1976, D65), in which about 2 can just be seen side by side.
"""

from collections.abc import Iterator, Mapping
from itertools import combinations

import numpy as np
import pytest
from numpy.typing import NDArray

from sheath_manip.playback import palette
from sheath_manip.playback.palette import Rgb
from sheath_manip.types import Actor

EYES = {
    "all cones": np.eye(3),
    "no long cones": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "no middle cones": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
}
TO_XYZ = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)
WHITE = np.array([0.95047, 1.0, 1.08883])
APART, LIGHTNESS_APART = 20.0, 7.0
"""of colours that stand alone: in any eyes, and in lightness"""
SEEN_APART = 7.0
"""of those that marker and dashes tell apart as well"""
HOUSE = (
    "sheath",
    "dagger",
    "cloning",
    "random-takeover",
    "sheath-own-labels",
    "random-blocks",
    "hg-dagger",
    "sheath-plain",
)
MAIN = HOUSE[:4]


def lab(rgb: Rgb, eyes: NDArray) -> NDArray[np.float64]:
    light = np.array(rgb) / 255
    light = np.where(light <= 0.04045, light / 12.92, ((light + 0.055) / 1.055) ** 2.4)
    shares = TO_XYZ @ np.clip(eyes @ light, 0, 1) / WHITE
    root = np.where(shares > (6 / 29) ** 3, np.cbrt(shares), shares / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * root[1] - 16, 500 * (root[0] - root[1]), 200 * (root[1] - root[2])])


def distances(colours: Mapping[str, Rgb]) -> Iterator[tuple[tuple[str, str], float, float]]:
    """Each pair with its least distance in any eyes, and that in lightness."""
    for pair in combinations(colours, 2):
        one, other = ([lab(colours[name], eyes) for eyes in EYES.values()] for name in pair)
        least = min(float(np.linalg.norm(a - b)) for a, b in zip(one, other, strict=True))
        yield pair, least, abs(one[0][0] - other[0][0])


def test_the_distances_are_those_of_the_textbook():
    np.testing.assert_allclose(lab((255, 255, 255), EYES["all cones"]), [100, 0, 0], atol=0.02)
    np.testing.assert_allclose(lab((255, 0, 0), EYES["all cones"]), [53.24, 80.1, 67.2], atol=0.1)
    # Who lacks middle cones confuses these; neither colour is used here.
    red, green = (lab(rgb, EYES["no middle cones"]) for rgb in ((163, 84, 0), (99, 113, 8)))
    plain = (lab(rgb, EYES["all cones"]) for rgb in ((163, 84, 0), (99, 113, 8)))
    assert np.linalg.norm(red - green) < 0.35 * np.linalg.norm(np.subtract(*plain))


def test_who_acts_is_told_apart_in_any_eyes_and_without_colours():
    # A fallback controller is drawn as the expert that it stands for.
    assert palette.ACTOR[Actor.FALLBACK] == palette.ACTOR[Actor.EXPERT]
    colours = {each.value: rgb for each, rgb in palette.ACTOR.items() if each != Actor.FALLBACK}
    for pair, least, in_lightness in distances(colours):
        assert least >= APART, pair
        assert in_lightness >= LIGHTNESS_APART, pair


def test_the_main_methods_are_told_apart_in_any_eyes_and_without_colours():
    looks = palette.methods(MAIN)
    for pair, least, in_lightness in distances({name: looks[name].rgb for name in MAIN}):
        assert least >= APART, pair
        assert in_lightness >= 4, pair


def test_any_two_methods_differ_in_marker_dashes_and_in_any_eyes():
    others = [f"other-{number}" for number in range(5)]
    looks = palette.methods((*HOUSE, *others))
    for one, other in combinations(looks.values(), 2):
        assert one.marker != other.marker
        assert one.dashes != other.dashes
        assert one.rgb != other.rgb
    for pair, least, _ in distances({name: look.rgb for name, look in looks.items()}):
        assert least >= SEEN_APART, pair


def test_a_look_does_not_hang_on_the_order_of_the_methods():
    names = ("other", "sheath", "another", "dagger")
    assert palette.methods(names) == palette.methods(sorted(names))


@pytest.mark.parametrize("rgb", [*palette.ACTOR.values(), *palette.OUTCOME.values()])
def test_letters_can_be_read_on_what_is_said_in_large(rgb):
    assert palette._contrast(rgb, palette.readable_on(rgb)) >= 4.5
