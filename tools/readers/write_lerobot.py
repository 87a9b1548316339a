"""LeRobot's writer at work: the only one of these scripts that imports this project.

python write_lerobot.py STORE OUT
"""

import sys
from pathlib import Path

import declare_torchvision  # noqa: F401

from sheath_manip.dataset.exchange.exporting import export
from sheath_manip.dataset.exchange.selection import Selection
from sheath_manip.dataset.store import EpisodeStore

store, out = EpisodeStore(sys.argv[1]), Path(sys.argv[2])
print(export(store, out, "lerobot", Selection()))
