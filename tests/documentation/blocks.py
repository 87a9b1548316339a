"""The fenced blocks of a page, and how they are run."""

import io
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import redirect_stdout
from dataclasses import dataclass
from pathlib import Path

from markdown_it import MarkdownIt

ROOT = Path(__file__).parents[2]
PAGES = {
    path.relative_to(ROOT).as_posix(): path
    for path in (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")))
}
NOT_RUN = {
    r"make |\. \.venv/bin/activate": "CI runs `make test`, which runs in that environment; "
    "tests/cli/test_cli_first_steps.py has `make demo`",
    r"pip (wheel|install) ": "tests/wheel",
    r"python examples/": "tests/test_examples.py",
    r"export AWS_|.*s3://": "wants a server: tests/dataset/test_remote.py has one",
    r"sheath data import (pusht|low_dim|lerobot/|D4RL/)": "files of other projects; "
    "tests/dataset/exchange has such files",
    r"sheath (run|learn|teleop) .*(--expert person|by-hand)": "waits for a person: tests/cockpit",
    r"sheath replay \S+$": "serves a page until Ctrl-C: tests/dashboard",
    r"sheath experiment": "takes an hour: tests/experiments",
    r"sheath \S+ \S+ --device cuda": "wants a GPU: tests marked for one compare it with the CPU",
    r"sheath learn fetch": "results/outside: tools/outside learns it in a venv of its own",
    r"pip install -e tests/guest_package|sheath learn slide": "tests/test_guest_package.py "
    "installs that package and learns its task",
}
"""shell lines, by their beginning, that no test runs as they stand, and why"""
FILES_NOT_RUN = {
    "docs/your-environment.md": (
        "tools/outside/fetch.py: wants gymnasium-robotics and an older MuJoCo, and results/outside",
        "tools/outside/lift.py: wants robosuite and an older MuJoCo, and results/outside",
    )
}
"""files that a page shows and no test runs, and why; what a page shows is the file"""
SECONDS = 400


@dataclass(frozen=True)
class Block:
    """A fenced block of a page."""

    page: str
    line: int
    """where it begins, from 1"""
    language: str
    text: str
    prints: str | None = None
    """of Python, what the `text` block that follows at once says that it prints"""


def blocks(page: str) -> list[Block]:
    """Return the fenced blocks of a page; an indented one, which names no language, is an error."""
    tokens = MarkdownIt().parse(PAGES[page].read_text())
    found = []
    for number, token in enumerate(tokens):
        assert token.type != "code_block", f"{page}: a block without a fence: {token.content}"
        if token.type != "fence":
            continue
        assert token.map
        after = tokens[number + 1] if number + 1 < len(tokens) else None
        told = after is not None and after.type == "fence" and after.info == "text"
        prints = after.content if after is not None and told and token.info == "python" else None
        found.append(Block(page, token.map[0] + 1, token.info, token.content, prints))
    return found


def calls_in_prose(page: str) -> Iterator[str]:
    """Yield what a page's sentences name, such as `sheath run --expert person`."""
    for token in MarkdownIt().enable("table").parse(PAGES[page].read_text()):
        for part in token.children or ():
            if part.type == "code_inline" and part.content.startswith("sheath "):
                yield " ".join(part.content.split())


def shell_lines(block: Block) -> Iterator[str]:
    """Yield a block's commands, each on one line and without its comment."""
    for line in block.text.replace("\\\n", " ").splitlines():
        command = " ".join(re.sub(r"\s#.*", "", line).split())
        if command and not command.startswith("#"):
            yield command


def reason_not_to_run(command: str) -> str | None:
    """Return why no test runs this command; None where one does."""
    return next((why for start, why in NOT_RUN.items() if re.match(start, command)), None)


def shows_a_file(block: Block) -> bool:
    """Whether a block is one of `FILES_NOT_RUN`, to the letter."""
    files = (line.partition(":")[0] for line in FILES_NOT_RUN.get(block.page, ()))
    return block.text in [(ROOT / file).read_text() for file in files]


def run_shell(block: Block, place: Path) -> None:
    """Run a block's commands in `place`, but for those that are not to be run."""
    path = os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"]))
    for command in shell_lines(block):
        if reason_not_to_run(command):
            continue
        done = subprocess.run(
            ["bash", "-c", command],
            cwd=place,
            env=os.environ | {"PATH": path, "PYTHONPATH": str(ROOT)},
            capture_output=True,
            text=True,
            timeout=SECONDS,
            check=False,
        )
        said = f"{block.page}:{block.line}: {command}\n{done.stdout}{done.stderr}"
        assert done.returncode == 0, said


def run_python(block: Block, names: dict[str, object]) -> None:
    """Run a Python block in `names`, which hold what the page's earlier ones named."""
    code = compile(block.text, f"{block.page}:{block.line}", "exec")
    printed = io.StringIO()
    with redirect_stdout(printed):
        exec(code, names)
    if block.prints is not None:
        said = printed.getvalue()
        assert said == block.prints, f"{block.page}:{block.line} printed {said!r}"
