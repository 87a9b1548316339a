"""What README and docs are: short, made from the results, without a dead link, in plain words."""

import json
import re
import shutil
from pathlib import Path

import pytest

from tests.documentation.blocks import PAGES, ROOT, blocks
from tools.docs.numbers import ended, failing_rounds, more, rate, takeovers_a_minute, with_interval
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
    # The recipe stands on the page of its task.
    assert results - {"grasp-clutter-recipe"} == shown


def test_numbers_are_shown_with_intervals_and_no_more_decimals_than_they_bear():
    figures = {"failure_rate": 0.0052083, "ci95": {"failure_rate": (0.00092, 0.0289)}}
    assert rate(figures) == "0.5 % (0.1–2.9)"
    ways = {"episodes": 50, "failure_rate": 0.1, "success_rate": 0.7}
    ways |= {"ci95": {"failure_rate": (0.04, 0.21), "success_rate": (0.56, 0.81)}}
    assert ended(ways) == "70 % (56–81) | 10 % (4–21) | 20 % (11–33)"
    assert with_interval(-0.0, (0.0, 17.2), " %") == "0 % (0–17)"
    assert more({"mean": -35.2, "ci95": (-42.0, 0.4)}) == "−35 (−42 … +0)"


def test_a_takeover_is_two_changes_of_who_acts():
    rounds = [{"round": 0, "horizon": 9.0}, {"round": 1, "horizon": 600.0}]
    rounds[1] |= {"executed": {"failure_rate": 0.1}}
    method = {"rounds": rounds, "overall": {"switches_per_episode": 6.0}}
    assert takeovers_a_minute(method, control_rate_hz=10) == 3
    assert failing_rounds(method) == [1]


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
