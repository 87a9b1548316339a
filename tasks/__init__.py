"""One dm_control task a folder, each runnable as a script; `table` lists them."""

from importlib import import_module
from importlib.util import find_spec

# First of all: it chooses the GL library, which MuJoCo takes when it is imported.
import sheath_manip  # noqa: F401
from sheath_manip.rollout.threads import one_thread_by_default

one_thread_by_default()

# Before any task imports dm_control, which opens an EGL display at once: Mesa's driver then brings
# its LLVM, triton has another, and loaded second it ends the process with a segmentation fault
# (triton 3.9 after Mesa 22.3). torch's default CUDA build imports triton with its first optimizer;
# the CPU build comes without it. `sheath --help` does not come past here.
for _name in ("torch", "triton"):
    if find_spec(_name):
        import_module(_name)

# Then OpenGL, before any task imports the simulator with it.
import_module("sheath_manip.tasks.opengl")
