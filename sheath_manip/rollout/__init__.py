"""The one control loop, and episodes run by it: here, in worker processes, recorded."""

from sheath_manip.rollout.loop import rollout

__all__ = ["rollout"]
