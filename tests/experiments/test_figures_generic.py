import json
import re
from collections.abc import Iterator
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from sheath_manip.cli.entry import run_command
from sheath_manip.cli.session import Catalog
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import StoreError, UnknownNameError
from sheath_manip.experiments.claims import read_summary
from sheath_manip.experiments.figures import FIGURES, OF_SUMMARIES, View, style, write_figures
from sheath_manip.experiments.figures.findings import bound, burden, failures, rates
from sheath_manip.experiments.figures.intervention import best_intervention
from sheath_manip.experiments.figures.replayed import pictures_of
from sheath_manip.experiments.figures.style import drawn_methods
from sheath_manip.experiments.summary import summarise
from sheath_manip.learning.config import LearningPlan
from sheath_manip.playback import palette
from sheath_manip.playback.written import quantity, shown
from sheath_manip.types import EpisodeInfo, Purpose
from tests.episodes import episode_of
from tests.experiments.interventions import episode
from tests.experiments.round_results import expert_records_of, results_of
from tests.toy import CORRIDOR

PLAN = LearningPlan().changed(
    comparison={"seeds": (0, 1), "evaluation_episodes": 6, "final_episodes": 4},
    schedule={"rounds": 3, "episodes": 5},
)


@pytest.fixture(scope="module")
def summary() -> dict:
    return summarise("toy", PLAN, results_of(PLAN), expert_records_of(PLAN), "sheath", 1.0)


def assert_shows_something(path: Path) -> None:
    with Image.open(path) as image:
        colours = image.convert("RGB").getcolors(maxcolors=1 << 24)
        pixels = np.asarray(image.convert("L"))
        if path.suffix == ".png":
            assert image.width == 1600
            assert path.stat().st_size < 300_000
    assert colours is not None
    assert len(colours) > 20
    # Ink over the whole picture, not in one corner.
    for half in (*np.array_split(pixels, 2, 0), *np.array_split(pixels, 2, 1)):
        assert (half < 200).mean() > 0.002


def test_every_figure_is_written_and_shows_something(summary, store, tmp_path):
    written = write_figures(tmp_path / "figures", summary, store)
    assert [path.name for path in written] == list(FIGURES)
    for path in written:
        assert_shows_something(path)


@pytest.mark.soak
def test_the_same_data_give_the_same_file(summary, store, tmp_path):
    names = ("rounds.png", "intervention.gif")
    first = write_figures(tmp_path / "a", summary, store, names=names)
    second = write_figures(tmp_path / "b", summary, store, names=names)
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]


def test_an_unknown_figure_lists_the_known_ones_and_nothing_is_written(summary, store, tmp_path):
    with pytest.raises(UnknownNameError, match=r"'round\.png'.*bound\.png.*mine\.png.*rounds\.png"):
        write_figures(
            tmp_path / "figures",
            summary,
            store,
            {"mine.png": lambda path: None},  # noqa: ARG005
            ["burden.png", "round.png"],
        )
    assert not (tmp_path / "figures").exists()


def test_a_task_adds_its_own_figures(summary, store, tmp_path):
    own = {"mine.png": lambda path: path.write_text("drawn")}
    assert write_figures(tmp_path, summary, store, own, ["mine.png"]) == [tmp_path / "mine.png"]


def test_without_an_intervention_only_its_pictures_are_missing(summary, tmp_path):
    store = EpisodeStore.create(tmp_path / "store")
    store.append(episode(0, "p" * 20))
    stale = tmp_path / "film_strip.png"
    stale.write_text("of an earlier run")
    names = ["burden.png", "film_strip.png"]
    assert write_figures(tmp_path, summary, store, names=names) == [tmp_path / "burden.png"]
    assert not stale.exists()


def test_without_a_camera_only_its_pictures_are_missing(summary, tmp_path):
    store = EpisodeStore.create(tmp_path / "store")
    info = EpisodeInfo("toy", 0, Purpose.LEARNING, 10.0, "sheath", 1)
    store.append(episode_of("p" * 20 + "eeee" + "p" * 20, info=info))
    names = ["burden.png", "film_strip.png", "intervention.gif"]
    assert write_figures(tmp_path, summary, store, names=names) == [tmp_path / "burden.png"]


def test_a_task_without_a_camera_is_looked_at_afterwards(summary, tmp_path):
    store = EpisodeStore.create(tmp_path / "store")
    info = EpisodeInfo("toy", 5, Purpose.LEARNING, 10.0, "sheath", 1, run_seed=2, variant="own")
    store.append(episode_of("p" * 20 + "eeee" + "p" * 20, info=info))
    made, restored = [], []

    def make(run_seed: int) -> SimpleNamespace:
        made.append(run_seed)
        return SimpleNamespace(
            reset=made.append, state=list, restore=restored.append, close=lambda: None
        )

    task = replace(
        CORRIDOR,
        run_variants={"own": make},
        picture=lambda _: np.full((40, 60, 3), 5 * len(restored), np.uint8),
    )
    pictures = pictures_of(task, "own")
    names = ["film_strip.png", "intervention.gif"]
    for path in write_figures(tmp_path, summary, store, None, names, View(pictures)):
        assert_shows_something(path)
    assert made == [2, 5, 2, 5]
    shown = best_intervention(store).window
    np.testing.assert_array_equal(
        restored[-1], store.read(episode_name(info)).steps[shown][-1].state
    )
    with Image.open(tmp_path / "intervention.gif") as image:
        assert image.width > image.height


@pytest.mark.soak
def test_of_ten_methods_each_has_its_look_and_a_panel_shows_six(tmp_path, drawings):
    names = [*PLAN.comparison.methods, *(f"other-{number}" for number in range(5))]
    assert len(set(palette.methods(names).values())) == len(names)
    assert drawn_methods(names) == list(PLAN.comparison.methods)
    assert drawn_methods(names[3:]) == names[3:9]
    results = results_of(PLAN)
    results |= dict.fromkeys(names[5:], results["dagger"])
    plan = PLAN.changed(schedule={"variant": "final"})
    summary = summarise("toy", plan, results, expert_records_of(PLAN), "sheath", 1.0)
    store = EpisodeStore.create(tmp_path / "store")
    for path in write_figures(tmp_path, summary, store, names=list(OF_SUMMARIES)):
        assert_shows_something(path)
    for figure in drawings:
        for axes in figure.axes:
            labels = {line.get_label() for line in axes.lines}
            assert len({shown(name) for name in names} & labels) <= 6


def test_titles_say_what_was_found(summary):
    for title in (failures, burden, bound, rates):
        said = title(summary)
        assert re.search(r"\d", said)
        changed = json.loads(json.dumps(summary))
        for method in changed["methods"].values():
            method["overall"] |= {"failure_rate": 0.75, "expert_share": 0.625}
            for entry in method["rounds"]:
                entry["measured"] = 1e6
        assert title(changed) != said


def test_where_the_expert_alone_drove_the_last_policy_counts(summary):
    cloning = {"cloning": summary["methods"]["cloning"]}
    said = rates({**summary, "methods": cloning})
    assert said.startswith("behaviour cloning's last policy fails in")


@pytest.fixture
def drawings(monkeypatch) -> list[Figure]:
    """Return the figures that are drawn from now on, as matplotlib has them."""
    drawn: list[Figure] = []
    inner = style.heading

    def noted(figure: Figure, title: str, below: str) -> None:
        drawn.append(figure)
        inner(figure, title, below)

    for name in ("rounds", "burden", "bound", "talk"):
        module = import_module(f"sheath_manip.experiments.figures.{name}")
        monkeypatch.setattr(module, "heading", noted)
    return drawn


@pytest.mark.soak
def test_words_fit_and_ticks_are_round_and_told_apart(tmp_path, drawings):
    # Many methods and wide ranges; one method, one round, and ranges of no width.
    for name in ("platformer", "grasp-clutter-recipe"):
        summary = read_summary(Path("results") / name / "summary.json")
        for draw in OF_SUMMARIES.values():
            draw(summary, tmp_path / "figure.png")
    for figure in drawings:
        for words in figure.texts:
            assert words.get_window_extent().x1 <= figure.bbox.width
        for axes in figure.axes:
            for axis in (axes.xaxis, axes.yaxis):
                ticks = axis.get_majorticklocs()
                if len(ticks) > 1:
                    step = float(np.diff(ticks).min())
                    assert f"{step:.6e}".rstrip("0")[0] in "125"
                    assert f"{step:.6e}"[2:8].strip("0") == ""
                labels = [label.get_text() for label in axis.get_ticklabels() if label.get_text()]
                assert len(labels) == len(set(labels))
    assert len(drawings) == 8


HIGHEST = {"laps": 3.0, "distance_tiles": 220.0} | dict.fromkeys(
    ("failure_rate", "success_rate", "success", "iou", "covered", "freed", "progress"), 1.0
)
"""what a figure of the committed results can be at most"""


def test_no_committed_interval_leaves_what_is_possible():
    def walk(content: Any) -> Iterator[tuple[str, list[float]]]:
        if isinstance(content, dict):
            if isinstance(content.get("ci95"), dict):
                yield from content["ci95"].items()
            for value in content.values():
                yield from walk(value)
        elif isinstance(content, list):
            for value in content:
                yield from walk(value)

    count = 0
    for path in sorted(Path("results").glob("*/summary.json")):
        for name, interval in walk(json.loads(path.read_text())):
            count += 1
            highest = HIGHEST.get(name, np.inf)
            assert all(value is None or 0 <= value <= highest for value in interval), (path, name)
    assert count > 500


def test_an_axis_says_quantity_and_unit():
    assert quantity("distance_tiles") == "distance (tiles)"
    assert quantity("laps") == "laps"


def test_a_film_to_the_end_of_its_episode_shows_the_last_observation(summary, tmp_path):
    store = EpisodeStore.create(tmp_path / "store")
    store.append(episode(0, "p" * 20 + "e" * 12))
    (path,) = write_figures(tmp_path, summary, store, names=["intervention.gif"])
    window = best_intervention(store).window
    assert window.stop == 32
    with Image.open(path) as film:
        assert film.size[0] >= 720
        assert film.n_frames == window.stop - window.start + 1  # pyright: ignore


@pytest.mark.soak
def test_results_are_drawn_again_from_their_summaries_alone(summary, tmp_path, capsys):
    def asked() -> int:
        return run_command(lambda: Catalog({}, {}), ["figures", "--results", str(tmp_path)])

    assert asked() == 2
    assert capsys.readouterr().err.count("\n") == 1
    (tmp_path / "toy").mkdir()
    path = tmp_path / "toy" / "summary.json"
    path.write_text(json.dumps(summary))
    assert asked() == 0
    assert {each.name for each in path.parent.iterdir()} == {path.name, *OF_SUMMARIES}
    assert (path.parent / summary["talk"]).exists()
    path.write_text(json.dumps({**summary, "methods": {}}))
    assert asked() == 2
    assert "lacks what its figures show" in capsys.readouterr().err


def test_a_damaged_store_is_not_passed_over(summary, store, tmp_path):
    next(store.path.glob("learning-sheath-*")).write_text("{")
    with pytest.raises(StoreError):
        write_figures(tmp_path, summary, store, names=["film_strip.png"])


@pytest.mark.soak
def test_the_figures_hold_where_a_method_has_no_colour_and_rounds_no_figures(store, tmp_path):
    results = results_of(PLAN)
    results["my-own"] = results.pop("hg-dagger")
    summary = summarise("toy", PLAN, results, [], "sheath", 1.0, metric="laps")
    for method in summary["methods"].values():
        method["final"]["metric"] = {}
    for path in write_figures(tmp_path, summary, store, names=["rounds.png", "bound.png"]):
        assert_shows_something(path)
