"""Rendering on this machine: the back end of GL in force, its libraries, and a frame as a trial."""

import ctypes
import os
import subprocess
import sys

GL_TIMEOUT_S = 60.0
"""a driver that hangs must not hang the doctor; a cold start takes about one second"""

GL_CURES = {
    "egl": "apt-get install libegl1 libopengl0 libgl1-mesa-dri",
    "osmesa": "apt-get install libosmesa6",
    "glfw": "run where there is a display, or set MUJOCO_GL=egl",
}

# Each entry is one library, by the names that it goes by.
GL_LIBRARIES = {
    "egl": (("libEGL.so.1", "libEGL.so"), ("libOpenGL.so.0", "libGL.so.1")),
    "osmesa": (("libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"),),
    "glfw": (("libGL.so.1", "libGL.so"),),
}

GL_OFF = ("disable", "disabled", "off", "false", "0")
"""MuJoCo's words for no rendering at all"""

# Run by another process, since a GL that failed to load poisons the one that tried, and since
# the core imports no simulator. Without shadows and multisampling, as the tasks render.
RENDER = """
import time
import mujoco
model = mujoco.MjModel.from_xml_string('''
    <mujoco>
      <visual><quality shadowsize="0" offsamples="0"/></visual>
      <worldbody><light pos="0 0 2"/><geom size="0.2"/></worldbody>
    </mujoco>''')
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
renderer = mujoco.Renderer(model, 64, 64)
times_ms = []
for _ in range(5):
    start_s = time.perf_counter()
    renderer.update_scene(data)
    image = renderer.render()
    times_ms.append(1e3 * (time.perf_counter() - start_s))
assert image.max() > 0, "the image is all black"
print(sorted(times_ms)[2])
"""


def gl_in_force() -> str:
    """The back end that MuJoCo takes in this process; `sheath_manip` sets it without a display."""
    backend = os.environ.get("MUJOCO_GL", "").lower().strip()
    return "glfw" if backend in ("", "enable", "enabled", "on", "true", "1") else backend


def render_time_ms(backend: str) -> float | str:
    """The median time of a small frame, or the last line of what went wrong."""
    environment = os.environ | {"MUJOCO_GL": backend}
    # Set by a MuJoCo that this process may have imported, for its own back end.
    environment.pop("PYOPENGL_PLATFORM", None)
    try:
        done = subprocess.run(
            [sys.executable, "-c", RENDER],
            env=environment,
            capture_output=True,
            text=True,
            timeout=GL_TIMEOUT_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"no answer in {GL_TIMEOUT_S:.0f} s"
    if done.returncode == 0:
        return float(done.stdout.split()[-1])
    lines = done.stderr.strip().splitlines()
    return lines[-1] if lines else f"the process ended with {done.returncode}"


def gl_problem(backend: str) -> str | None:
    """Return why rendering with `backend` cannot work here, and the cure; None where it may.

    Its libraries are looked for, and nothing is rendered.
    """
    if backend in GL_OFF:
        return f"MUJOCO_GL={backend} turns rendering off; cure: unset MUJOCO_GL"
    if backend not in GL_LIBRARIES:
        known = ", ".join(GL_LIBRARIES)
        return f"rendering wants MUJOCO_GL to be one of {known}, it is {backend!r}"
    if sys.platform != "linux":
        return None
    for names in GL_LIBRARIES[backend]:
        if not any(_loads(name) for name in names):
            wanted = f"rendering with MUJOCO_GL={backend} wants {names[0]}"
            return f"{wanted}, which this machine lacks; {cure_of(backend)}"
    return None


def gl_failure(backend: str, error: BaseException) -> str:
    """Return what is told where rendering with `backend` was tried and failed."""
    # Drivers say nothing, or many lines.
    said = (str(error).strip().splitlines() or [type(error).__name__])[0].rstrip(".")
    return f"rendering with MUJOCO_GL={backend} does not work here ({said}); {cure_of(backend)}"


def cure_of(backend: str) -> str:
    """Return what helps where `backend` does not work."""
    return f"cure: {GL_CURES[backend]} (`sheath doctor` tells more)"


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True
