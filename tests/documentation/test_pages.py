"""What README and docs are: short, made from the results, without a dead link, in plain words."""

import json
import re
import shutil
from pathlib import Path

import pytest

from sheath_manip.experiments.claims import UNINFORMED, uninformed
from tests.documentation.blocks import PAGES, ROOT, blocks
from tools.docs.numbers import (
    alike,
    burden_cells,
    ended,
    failing_rounds,
    more,
    rate,
    takeovers_a_minute,
    with_interval,
)
from tools.docs.pages import pages
from tools.make_docs import main

LINK = re.compile(r"\]\(([^)\s]+)\)")
MADE = dict(pages())
BY_HAND = {
    name: ROOT / name for name in ("CONTRIBUTING.md", "CHANGELOG.md", "assets/arm/README.md")
}


def test_the_readme_is_short():
    text = MADE["README.md"]
    assert len(text.splitlines()) <= 130
    assert len(text.split()) <= 1000


def test_the_readme_gates_a_policy_in_twelve_lines():
    [block] = [block for block in blocks("README.md") if block.language == "python"]
    assert len([line for line in block.text.splitlines() if line.strip()]) == 12


@pytest.mark.parametrize("name", MADE)
def test_a_page_is_what_is_generated(name):
    assert (ROOT / name).read_text() == MADE[name], (
        f"{name} is behind what it is made from; wanted `python -m tools.make_docs`"
    )


def test_making_them_again_changes_nothing(capsys):
    assert main() == 0
    assert capsys.readouterr().out == ""


def test_another_number_in_a_summary_is_another_number_on_the_pages(tmp_path):
    results = tmp_path / "results"
    shutil.copytree(ROOT / "results", results, ignore=shutil.ignore_patterns("*.png", "*.gif"))
    path = results / "driving" / "summary.json"
    summary = json.loads(path.read_text())
    summary["methods"]["dagger"]["overall"]["failure_rate"] = 0.123
    path.write_text(json.dumps(summary))
    changed = {name for name, text in pages(results) if text != MADE[name]}
    assert changed == {"README.md", "docs/results/driving.md", "docs/results/index.md"}
    made = dict(pages(results))
    assert all("12.3 %" in made[name] for name in changed)


def test_every_result_has_its_page_and_every_page_its_result():
    results = {
        path.relative_to(ROOT / "results").parts[0] for path in ROOT.glob("results/**/summary.json")
    }
    shown = {path.stem for path in (ROOT / "docs" / "results").glob("*.md")} - {"index"}
    # The recipe and the hard scenes stand on the page of their task.
    assert results - {"grasp-clutter-recipe", "grasp-clutter-hard"} == shown


def test_the_hard_scenes_have_a_section_once_there_is_a_result_of_them(tmp_path):
    results = tmp_path / "results"
    shutil.copytree(ROOT / "results", results, ignore=shutil.ignore_patterns("*.png", "*.gif"))
    shutil.rmtree(results / "grasp-clutter-hard", ignore_errors=True)
    page, heading = "docs/results/grasp-clutter.md", "## On the hard scenes"
    assert heading not in dict(pages(results))[page]
    shutil.copytree(results / "grasp-clutter", results / "grasp-clutter-hard")
    assert heading in dict(pages(results))[page]


def test_numbers_are_shown_with_intervals_and_no_more_decimals_than_they_bear():
    figures = {"failure_rate": 0.0052083, "ci95": {"failure_rate": (0.00092, 0.0289)}}
    assert rate(figures) == "0.5 % (0.1–2.9)"
    ways = {"episodes": 50, "failure_rate": 0.1, "success_rate": 0.7}
    ways |= {"ci95": {"failure_rate": (0.04, 0.21), "success_rate": (0.56, 0.81)}}
    assert ended(ways) == "70 % (56–81) | 10 % (4–21) | 20 % (11–33)"
    assert with_interval(-0.0, (0.0, 17.2), " %") == "0 % (0–17)"
    assert more({"mean": -35.2, "ci95": (-42.0, 0.4)}) == "−35 (−42 … +0)"


def test_of_an_older_result_a_takeover_is_two_changes_of_who_acts():
    rounds = [{"round": 0, "horizon": 9.0}, {"round": 1, "horizon": 600.0, "runs": 2}]
    rounds[1] |= {"executed": {"failure_rate": 0.1}}
    overall = {"switches_per_episode": 6.0, "expert_share": 0.1, "queries": 300, "episodes": 20}
    method = {"rounds": rounds, "overall": overall}
    assert takeovers_a_minute(method, control_rate_hz=10) == 3
    assert failing_rounds(method) == [1]
    assert burden_cells(method, 10) == "3.0 | 3.0 | 2.00 | – | 6.0 s | 10 % | 30 | 300"


def test_a_newer_result_says_its_burdens_itself():
    burdens = {"takeovers_an_episode": 1.5, "takeovers_a_minute": 4.25, "median_takeover_s": 0.8}
    burdens |= {"driving_s_an_episode": 3.0, "labels_an_episode": 40.0}
    overall = {**burdens, "expert_share": 0.08, "queries": 1320, "episodes": 33}
    method = {"rounds": [{"round": 1, "horizon": 400.0, "runs": 1}], "overall": overall}
    assert burden_cells(method, 10) == "1.5 | 4.2 | 2.00 | 0.80 | 3.0 s | 8 % | 40 | 1,320"


def test_takeovers_at_random_are_named_by_what_they_share_with_sheaths():
    older, newer = ({"methods": {"sheath": {}, name: {}}} for name in UNINFORMED[::-1])
    assert (uninformed(older), alike(older)) == ("random-takeover", "of the same share")
    assert (uninformed(newer), alike(newer)) == ("random-blocks", "as many and as long")
    with pytest.raises(KeyError, match="random-blocks or random-takeover"):
        uninformed({"methods": {}})


@pytest.mark.parametrize("name", [name for name in PAGES if name.startswith("docs/")])
def test_a_page_says_at_its_top_who_it_is_for(name):
    lines = [line for line in PAGES[name].read_text().splitlines() if line.strip()]
    lines = lines[1:] if lines[0].startswith("<!--") else lines
    assert lines[0].startswith("# ")
    assert lines[1].startswith("**For** ")


@pytest.mark.parametrize("name", [*PAGES, *BY_HAND])
def test_no_link_inside_is_dead(name):
    page = (PAGES | BY_HAND)[name]
    dead = [link for link in LINK.findall(page.read_text()) if _is_dead(page, link)]
    assert not dead


def _is_dead(page: Path, link: str) -> bool:
    if re.match(r"https?:", link):
        return False
    path, _, heading = link.partition("#")
    there = (page.parent / path).resolve() if path else page
    if not heading:
        return not there.exists()
    return heading not in {_anchor(line) for line in there.read_text().splitlines()}


def _anchor(line: str) -> str:
    """The anchor of a heading, as GitHub and MyST make it."""
    words = re.sub(r"[^\w\- ]", "", line.lstrip("# ").lower())
    return words.replace(" ", "-") if line.startswith("#") else ""


def test_what_the_command_names_of_the_documentation_is_there():
    named = {
        name
        for path in (ROOT / "sheath_manip").rglob("*.py")
        for name in re.findall(r"docs/[\w/-]+\.md", path.read_text())
    }
    assert "docs/security.md" in named
    assert all((ROOT / name).exists() for name in named)


def test_the_words_are_plain():
    for name, page in PAGES.items():
        odd = re.findall(r"\b(whom|whoever|likewise)\b", page.read_text(), re.IGNORECASE)
        assert not odd, name
