"""A pool of bodies that a new scene gives their shapes and places, without compiling anything."""

from typing import Any

import mujoco
import numpy as np
from dm_control import mjcf
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.tasks.grasp_clutter.objects import Kind, StandingObject
from sheath_manip.tasks.grasp_clutter.scene import POOL, Scene

_TARGET = "target"
SLOTS = ((_TARGET, Kind.CAN), *((f"{k}_{i}", k) for k, many in POOL.items() for i in range(many)))
"""name and kind of each body, the target's first"""
_PARKED_M = -1.0
"""height at which bodies wait that a scene does not need: under the table, where nothing shows"""
_PART = ("foot", "neck")


_OF_BODIES = ("body_mass", "body_inertia", "body_ipos", "body_iquat")
_OF_GEOMS = ("geom_pos", "geom_size", "geom_rgba", "geom_rbound", "geom_aabb")
"""the model's arrays that a scene shapes"""
_UNSEEN = 1e-6
"""of an opacity of 1: it changes no picture; with 0 a page would take the geom for one fewer"""


def add_pool(root: mjcf.RootElement, *, movable: bool) -> None:
    """Add the pool's bodies to `root`: free to move, or as mocap bodies without mass."""
    worldbody: Any = root.worldbody
    for name, kind in SLOTS:
        body = worldbody.add("body", name=name, pos=[0, 0, _PARKED_M])
        if movable:
            body.add("freejoint", name=name)
            # Any values will do that the compiler takes for those of no particular shape: off the
            # body's origin and different along all axes.
            body.add("inertial", pos=[0, 0, 0.07], mass=0.2, diaginertia=[3e-4, 2.9e-4, 1e-4])
        else:
            body.mocap = "true"
        parts = _PART[: 2 if kind is Kind.BOTTLE else 1]
        for height, part in zip((0.05, 0.12), parts, strict=False):
            body.add(
                "geom",
                name=f"{name}_{part}",
                dclass="standing" if movable else None,
                type="box" if kind is Kind.BOX else "cylinder",
                pos=[0, 0, height],
                size=[0.03, 0.03, 0.05] if kind is Kind.BOX else [0.03, 0.05],
            )


def geom_names(name: str, kind: Kind) -> list[str]:
    """The geoms of a slot."""
    return [f"{name}_{part}" for part in _PART[: 2 if kind is Kind.BOTTLE else 1]]


class Pool:
    """The pool's bodies in one compiled model."""

    def __init__(self, model: mujoco.MjModel, prefix: str = "") -> None:
        self._model = model
        self.bodies = [model.body(prefix + name).id for name, _ in SLOTS]
        self._geoms = [
            [model.geom(prefix + geom).id for geom in geom_names(name, kind)]
            for name, kind in SLOTS
        ]
        self._free = [int(model.body_jntadr[body]) for body in self.bodies]
        # One after the other, as they were added.
        self._rows = slice(self.bodies[0], self.bodies[-1] + 1)
        self._compiled = {name: getattr(model, name).copy() for name in _OF_BODIES + _OF_GEOMS}
        self._scratch = mujoco.MjData(model)
        self.slots: tuple[int, ...] = ()
        """of the scene's objects, in their order: indices into `bodies`"""

    @property
    def laid_bodies(self) -> NDArray[np.int64]:
        """(n,) the scene's bodies, the target's first."""
        return np.array([self.bodies[slot] for slot in self.slots])

    def shape(self, scene: Scene) -> None:
        """Give bodies the shapes and masses of `scene`, and take the others out of the world."""
        self.slots = _assigned(scene)
        model = self._model
        for slot, geoms in enumerate(self._geoms):
            present = slot in self.slots
            model.geom_contype[geoms] = model.geom_conaffinity[geoms] = int(present)
            model.body_gravcomp[self.bodies[slot]] = 0.0 if present else 1.0
            if not present:
                self._hide(slot)
        for slot, each in zip(self.slots, scene.objects, strict=True):
            self._shape(slot, each)
        # What MuJoCo derives from masses and inertias.
        mujoco.mj_setConst(model, self._scratch)

    def place(self, data: mujoco.MjData, scene: Scene) -> None:
        """Stand the objects of `scene` on the table at rest, the rest of the pool under it."""
        model = self._model
        where = dict(zip(self.slots, scene.objects, strict=True))
        for slot, joint in enumerate(self._free):
            position, velocity = model.jnt_qposadr[joint], model.jnt_dofadr[joint]
            data.qvel[velocity : velocity + 6] = 0.0
            if slot in where:
                data.qpos[position : position + 7] = _pose(where[slot])
            else:
                data.qpos[position : position + 7] = [0.2 * slot, 0, _PARKED_M, 1, 0, 0, 0]

    def momenta(self, data: mujoco.MjData) -> NDArray[np.float64]:
        """Return the (p, 3) momenta of the pool's centres of mass, N s, in the world frame."""
        model, bodies = self._model, self._rows
        start = model.jnt_dofadr[self._free[0]]
        # A free joint moves the body's origin, the object's foot, and turns about the body's axes.
        rates = data.qvel[start : start + 6 * len(self.bodies)].reshape(-1, 6)
        axes = data.xmat[bodies].reshape(-1, 3, 3)
        turning = rates[:, 4:5] * axes[:, :, 0] - rates[:, 3:4] * axes[:, :, 1]
        velocities = rates[:, :3] + model.body_ipos[bodies, 2:] * turning
        return model.body_mass[bodies, None] * velocities

    def _hide(self, slot: int) -> None:
        """Let nothing of an earlier scene be left: a camera at the table's edge sees below it."""
        model = self._model
        for names, rows in ((_OF_BODIES, self.bodies[slot]), (_OF_GEOMS, self._geoms[slot])):
            for name in names:
                getattr(model, name)[rows] = self._compiled[name][rows]
        model.geom_rgba[self._geoms[slot], 3] = _UNSEEN

    def _shape(self, slot: int, each: StandingObject) -> None:
        model, body = self._model, self.bodies[slot]
        model.body_mass[body] = each.mass_kg
        model.body_inertia[body] = each.inertia_kg_m2
        model.body_ipos[body] = [0, 0, each.centre_of_mass_m]
        model.body_iquat[body] = [1, 0, 0, 0]
        for geom, part in zip(self._geoms[slot], each.parts, strict=True):
            half = part.half_height_m
            model.geom_pos[geom] = [0, 0, part.centre_m]
            model.geom_size[geom] = (
                [part.half_x_m, half, 0] if part.round else [part.half_x_m, part.half_y_m, half]
            )
            model.geom_rgba[geom] = each.rgba
            across = part.half_x_m if part.round else np.hypot(part.half_x_m, part.half_y_m)
            # What the broad phase takes for the radius of a sphere around the part.
            model.geom_rbound[geom] = np.hypot(across, half)
            model.geom_aabb[geom] = [0, 0, 0, part.half_x_m, part.half_y_m, half]


def _assigned(scene: Scene) -> tuple[int, ...]:
    free = {kind: [i for i, (_, k) in enumerate(SLOTS) if k is kind and i] for kind in Kind}
    slots = [0]
    for each in scene.clutter:
        if not free[each.kind]:
            raise ParameterError(
                f"more than {POOL[each.kind]} objects of kind {each.kind} in the clutter; "
                f"the pool holds {', '.join(f'{many} {kind}' for kind, many in POOL.items())}"
            )
        slots.append(free[each.kind].pop(0))
    return tuple(slots)


def _pose(each: StandingObject) -> list[float]:
    half = each.yaw_rad / 2
    return [each.x_m, each.y_m, 0.0, np.cos(half), 0.0, 0.0, np.sin(half)]
