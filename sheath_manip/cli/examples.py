"""One example for each verb, and what to do first: lines that go on from one another."""

FIRST_STEPS = """\
sheath: a robot learns from an expert without first having to fail.

First steps; each line goes on from the one before, the first three take a minute:

  sheath collect driving --episodes 13 --store runs/demos
                        record laps that the scripted expert drives
  sheath train driving --store runs/demos --calibration 3 --checkpoint runs/first.npz
                        fit a policy to ten of them, and its gate
  sheath run driving --checkpoint runs/first.npz --episodes 5 --store runs/first
                        let it drive; where the gate does not trust it, the expert does
  sheath replay runs/first
                        look in the browser at who drove when, and why

  sheath doctor         what this machine lacks, and how to install it
  sheath tasks          the tasks, policies, signals and methods to choose from
  sheath --help         all verbs; sheath VERB --help: its options and an example
"""

EXAMPLES = {
    "tasks": "sheath tasks",
    "claims": "sheath claims",
    "figures": "sheath figures --results results",
    "doctor": "sheath doctor",
    "collect": "sheath collect driving --episodes 13 --store runs/demos",
    "teleop": "sheath teleop grasp-clutter --store runs/by-hand",
    "train": "sheath train driving --store runs/demos --calibration 3 --checkpoint runs/first.npz",
    "learn": "sheath learn driving --runs runs/taught --expert person",
    "run": "sheath run driving --checkpoint runs/first.npz --episodes 5 --store runs/first",
    "evaluate": "sheath evaluate driving --checkpoint runs/first.npz --episodes 20",
    "experiment": "sheath experiment driving --quick --dashboard",
    "dashboard": "sheath dashboard driving --checkpoint runs/first.npz",
    "gate": "sheath gate show gate.npz",
    "gate fit": "sheath gate fit --policy mine.py:act --data runs/demos --out gate.npz",
    "gate show": "sheath gate show gate.npz",
    "replay": "sheath replay runs/first",
    "data": "sheath data list runs/demos",
    "data list": "sheath data list runs/demos",
    "data show": "sheath data show runs/demos --episode -1",
    "data check": "sheath data check runs/demos",
    "data export": "sheath data export runs/demos demos.zarr.zip --format replay-buffer",
    "data import": "sheath data import demos.zarr.zip runs/again --format replay-buffer",
    "data merge": "sheath data merge runs/demos runs/first --into runs/all",
    "data split": "sheath data split runs/demos train=0.8 test=0.2 --into runs/parts",
    "data drop": "sheath data drop runs/demos demonstration-expert-s0-r00-i000-seed736546171",
    "data repair": "sheath data repair runs/demos",
}
"""by the verb"""


def described(verb: str, words: str | None) -> str:
    """Return the text of a verb's own help: what it does, and its example."""
    return f"{words or ''}\n\nExample: {EXAMPLES[verb]}".strip()
