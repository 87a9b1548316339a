"""The core of sheath-manip: learning from an expert under a gate."""

import os
import sys

# Without a display MuJoCo must be told to render off screen before it is first imported.
if sys.platform == "linux" and not os.environ.get("DISPLAY"):
    os.environ.setdefault("MUJOCO_GL", "egl")
