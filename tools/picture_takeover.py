"""Films of a takeover, from episodes that were recorded.

    python -m tools.picture_takeover STORE [--film docs/takeover.gif]
                                    [--strip STRIP.png] [--note "plan quick"]

shows the most telling takeover of the store: who acts and why, the score against its threshold, and
a time axis. Any run of rounds makes a store, such as `sheath experiment driving --quick`, which
leaves it in runs/driving/store.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.experiments.figures import View, film, film_strip
from sheath_manip.experiments.figures.intervention import best_intervention
from sheath_manip.experiments.figures.replayed import pictures_of
from sheath_manip.tasks.table import TASKS


def main(arguments: Sequence[str] | None = None) -> None:
    """Choose, draw and write."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("store", type=Path)
    parser.add_argument("--method", default="sheath")
    parser.add_argument("--film", type=Path, default=Path("docs/takeover.gif"))
    parser.add_argument("--strip", type=Path)
    parser.add_argument("--note", default="", help="what a strip must say of the run")
    options = parser.parse_args(arguments)
    store = EpisodeStore(options.store)
    task = TASKS[store.summary(store.names()[0]).info.task]
    action = task.make().spec.action
    shown = best_intervention(store, options.method, View(pictures_of(task, "default"), action))
    film(shown, options.film)
    if options.strip is not None:
        film_strip(shown, options.strip, options.note)


if __name__ == "__main__":
    main()
