"""Roll out and look: an expert drives, the episode is recorded, read again and drawn.

    python examples/roll_out.py [--task driving] [--store runs/examples] [--picture roll_out.png]

Shows the loop of an episode, the store, and what a recording holds; any task of `sheath tasks`
does. In the picture: the first moment, one in the middle, and the last observation.
"""

import argparse
from pathlib import Path

import numpy as np
from PIL import Image

import sheath_manip as sheath
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.recorder import Recorder
from sheath_manip.gates import AlwaysExpert
from sheath_manip.rollout import rollout
from sheath_manip.tasks.table import TASKS


def main(arguments: list[str] | None = None) -> None:
    """Drive, record, read and draw."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--task", default="driving")
    parser.add_argument("--seed", type=int, default=1, help="of the scene")
    parser.add_argument("--store", type=Path, default=Path("runs/examples"))
    parser.add_argument("--picture", type=Path, default=Path("roll_out.png"))
    options = parser.parse_args(arguments)

    task = TASKS[options.task]
    environment = task.make()
    info = sheath.EpisodeInfo.of(
        environment.spec, variant="default", seed=options.seed, purpose=sheath.Purpose.DEMONSTRATION
    )
    store = sheath.EpisodeStore.create(options.store)
    if not store.has(info):
        expert, listeners = task.expert(environment), [Recorder(store)]
        # A gate says who acts, here always the same; the recorder hears of each step.
        rng, gate = np.random.default_rng(options.seed), AlwaysExpert()
        rollout(environment, info, gate, rng=rng, expert=expert, listeners=listeners)
    environment.close()

    episode = store.read(episode_name(info))
    columns = episode.columns
    print(f"{len(episode)} steps, {episode.outcome}, {dict(episode.metrics)}")
    print(f"features {columns.features.shape}, labels {columns.labels.shape}")
    sheet = sheath.contact_sheet(task, episode, (0, len(episode) // 2, -1))
    Image.fromarray(sheet).save(options.picture)


if __name__ == "__main__":
    main()
