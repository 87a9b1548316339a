"""Train and gate: demonstrations, a policy, its gate, and an episode under that gate.

    python examples/train_and_gate.py [--demonstrations 5] [--picture train_and_gate.png]

What `sheath collect`, `train` and `run` do. The threshold is set on episodes that no fit has seen;
below it the expert takes over. In the picture: the start, a takeover, and the end.
"""

import argparse
from pathlib import Path

import numpy as np
from PIL import Image

import sheath_manip as sheath
from sheath_manip.tasks.table import TASKS

GATE = sheath.GateConfig(
    signal="trust-joined",
    embedding="weighted-features",
    precedent_embedding="weighted-features",
)


def main(arguments: list[str] | None = None) -> None:
    """Demonstrate, fit, drive and draw."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--demonstrations", type=int, default=5, help="the last three set the gate")
    parser.add_argument("--picture", type=Path, default=Path("train_and_gate.png"))
    options = parser.parse_args(arguments)

    task, variant = TASKS["platformer"], "one-stage"
    shown = sheath.demonstrations(task, options.demonstrations, variant)
    states = sheath.samples_from(shown[:-3])
    held_out = [sheath.samples_from([each]) for each in shown[-3:]]
    environment = task.make(variant)
    policy = sheath.make_policy("linear-svm", environment.spec).fit(states)
    environment.close()
    fit = sheath.fit_gate(policy, states, held_out, GATE, sources=sheath.Sources())
    checkpoint = sheath.Checkpoint(task.name, "linear-svm", policy, fit.gate)

    episode = sheath.gated_episode(task, checkpoint, variant, seed=7)
    takeover = np.flatnonzero(~episode.columns.by_policy)
    print(f"{episode.outcome}; the expert acted in {len(takeover)} of {len(episode)} steps")
    moments = (0, int(takeover[0]) if takeover.size else 0, -1)
    Image.fromarray(sheath.contact_sheet(task, episode, moments)).save(options.picture)


if __name__ == "__main__":
    main()
