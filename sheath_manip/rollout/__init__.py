"""The one control loop, and episodes run by it: here, in worker processes, recorded."""
