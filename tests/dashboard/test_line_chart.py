"""The learning curves as SVG text: what lies where, and what is said of each round."""

import re

import numpy as np
import pytest

from sheath_manip.dashboard.chart_numbers import Curve, Form
from sheath_manip.dashboard.line_chart import HEIGHT, LEFT, WIDTH, line_chart
from sheath_manip.dashboard.widgets.now_running import running_words
from sheath_manip.learning.curves import Reading
from sheath_manip.learning.results import EXPERT
from sheath_manip.playback import palette
from sheath_manip.types import EpisodeInfo, Purpose

NAN = float("nan")
LOOK = palette.methods(("sheath",))["sheath"]
DASHED = palette.methods(("dagger",))["dagger"]


def reading(value: float, low: float, high: float, *seeds: float) -> Reading:
    return Reading(value, (low, high), 30, dict(enumerate(seeds)))


def curve(name: str = "SHEATH", look: palette.Look = LOOK, **start: dict) -> Curve:
    line = {1: reading(0.2, 0.1, 0.5, 0.1, 0.3), 2: reading(0.0, 0.0, 0.3, 0.0, 0.0)}
    return Curve(name, look, line, **start)


def places(drawn: str) -> np.ndarray:
    """(n, 2) the corners of all bands, lines and markers of the chart itself."""
    chart = drawn.split("<template")[0]
    points = " ".join(re.findall(r'points="([^"]*)"', chart))
    return np.array([pair.split(",") for pair in points.split()], float)


def test_all_that_is_drawn_lies_in_the_picture():
    drawn = line_chart("Failed", [curve(), curve("DAgger", DASHED)], Form())
    x, y = places(drawn).T
    assert x.min() >= LEFT - 0.1
    assert x.max() <= WIDTH
    assert y.min() >= 0
    assert y.max() <= HEIGHT


def test_the_axis_holds_the_intervals_and_is_in_per_cent():
    drawn = line_chart("Failed", [curve()], Form())
    ticks = [float(tick) for tick in re.findall(r">([\d.]+) %</text>", drawn)]
    assert ticks[0] == 0
    assert ticks[-1] >= 50
    assert len(ticks) == len(set(ticks)) > 2


def test_each_round_says_mean_interval_episodes_and_each_seed():
    drawn = line_chart("Failed", [curve()], Form())
    first, second = re.findall(r"<template.*?</template>", drawn)
    for words in ("Failed, round 1", "20 %", "(10–50 %)", "30 episodes", "0: 10 % · 1: 30 %"):
        assert words in first
    assert "Failed, round 2" in second
    assert "(0–30 %)" in second


def test_there_is_a_dot_for_each_of_several_seeds_and_none_for_one():
    assert line_chart("Failed", [curve()], Form()).count("<circle") == 4
    alone = Curve("SHEATH", LOOK, {1: reading(0.2, 0.1, 0.5, 0.2)})
    assert "<circle" not in line_chart("Failed", [alone], Form())


def test_a_name_that_looks_like_markup_is_text():
    drawn = line_chart("<b>Failed</b>", [curve("<script>alert(1)</script>")], Form())
    assert "<script" not in drawn
    assert "<b>Failed</b>," not in drawn
    assert drawn.count("&lt;script&gt;alert(1)&lt;/script&gt;") == 3


def test_what_all_methods_begin_with_is_drawn_on_and_said_once():
    start = {0: reading(0.6, 0.4, 0.8, 0.5, 0.7)}
    first = Curve("cloned policy", palette.Look(palette.INK, "o"), start)
    drawn = line_chart("Failed", [curve(start=start), first], Form())
    zero, one, _ = re.findall(r"<template.*?</template>", drawn)
    assert "cloned policy" in zero
    assert "SHEATH" not in zero
    assert "cloned policy" not in one
    lines = re.findall(r'<polyline points="([^"]*)"', drawn.split("<template")[0])
    assert [len(line.split()) for line in lines] == [3, 1]
    assert lines[0].split()[0] == lines[1]


def test_without_a_number_there_is_no_chart_and_a_gap_is_said():
    nothing = Reading(NAN, (NAN, NAN), 0, {0: NAN})
    assert line_chart("IoU", [Curve("SHEATH", LOOK, {1: nothing})], Form(False, None)) == ""
    gap = Curve("SHEATH", LOOK, {1: reading(0.9123, 0.8, 0.95), 2: nothing})
    drawn = line_chart("IoU", [gap], Form(False, None))
    assert "nan" not in drawn.lower()
    assert "(0.8–0.95)" in drawn
    assert "0.912" in drawn


@pytest.mark.parametrize("value", [0.0, 0.5, 1.0, 3.0])
def test_one_point_alone_is_drawn_too(value):
    drawn = line_chart("laps", [Curve("a", LOOK, {0: reading(value, value, value)})], Form(False))
    assert np.isfinite(places(drawn)).all()


def test_what_runs_now_is_said_in_words():
    def info(method: str) -> EpisodeInfo:
        return EpisodeInfo("toy", 0, Purpose.LEARNING, 10.0, method, 3, run_seed=1)

    assert running_words(info("dagger"), "") == "DAgger, training seed 1, round 3"
    said = running_words(info("sheath"), "fitting round 3")
    assert said == "SHEATH, training seed 1, round 3: fitting round 3"
    assert running_words(info(EXPERT), "") == "Demonstrations, training seed 1"
