"""Makes README.md and the pages of docs/ that hold numbers, or follow from the command's types.

    python -m tools.make_docs

writes what `tools/docs/templates` makes of results/*/summary.json and results/bench-*.json, and the
page of the command line. `make docs` then builds the site of all pages.
"""

import sys

from tools.docs.pages import ROOT, pages


def main() -> int:
    """Write the pages that differ, and name them."""
    for name, text in pages():
        path = ROOT / name
        if not path.exists() or path.read_text() != text:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
            print(f"wrote {name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
