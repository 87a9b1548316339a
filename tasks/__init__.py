"""One dm_control task a folder, each runnable as a script; `table` lists them."""

import os

# First of all: it chooses the GL library, which MuJoCo takes when it is imported.
import sheath_manip  # noqa: F401

# Before numpy and torch start their threads: on two cores, two threads in each of two processes
# cost many times what they give. Whoever knows better sets the variable.
os.environ.setdefault("OMP_NUM_THREADS", "1")
