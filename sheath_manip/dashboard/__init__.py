"""The live page of a run: scene, gate, support, pause, replay, and the lock on its door."""

from sheath_manip.dashboard.dashboard import Dashboard
from sheath_manip.dashboard.replay import Replay

__all__ = ["Dashboard", "Replay"]
