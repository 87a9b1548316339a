"""Puts an arm together from its file: its model as it comes, servos, and a tool at its end."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from dm_control import mjcf

from sheath_manip.exceptions import ParameterError, SheathError
from sheath_manip.tasks.robots.arm_file import ArmFile, Vector, read_arm
from sheath_manip.tasks.robots.elements import found, inherited
from sheath_manip.tasks.robots.fingers import add_gripper, open_positions
from sheath_manip.tasks.robots.models import located
from sheath_manip.tasks.robots.robot import ASSETS
from sheath_manip.tasks.robots.thinning import thin

_FROM_M = 0.001
"""links that are so close at home are so by their shapes, and are not to push each other"""
_SITES, _COLLIDING = 4, 3
"""groups; MuJoCo draws none beyond 2"""


@dataclass(frozen=True)
class ArmWithGripper:
    """Builds the arm of a file with its gripper; can be pickled."""

    path: Path

    def __call__(self) -> mjcf.RootElement:
        """Return the arm as MJCF; raises ParameterError and SetupError."""
        touching = _touching(self.path)
        root = _with_gripper(read_arm(self.path), self.path)
        for first, second in touching:
            root.contact.add("exclude", body1=first, body2=second)
        return root


@dataclass(frozen=True)
class ArmWithBlade:
    """Builds the arm of a file with the needle knife; can be pickled."""

    path: Path

    def __call__(self) -> mjcf.RootElement:
        """Return the arm as MJCF; raises ParameterError and SetupError."""
        arm = read_arm(self.path)
        root = _arm(arm, self.path)
        names = {joint.name for joint in arm.joints}
        # A gripper in the arm's own model holds the knife and does not move.
        for kind in ("equality", "tendon", "contact"):
            for element in root.find_all(kind):
                element.remove()
        for joint in root.find_all("joint"):
            if joint.name not in names:
                joint.remove()
        turned: Any = mjcf.RootElement(model="turned")
        axes = [*arm.mount.approach, *arm.mount.across]
        site = turned.worldbody.add("site", name="mount", xyaxes=axes, group=_SITES)
        site.attach(mjcf.from_path(str(ASSETS / "blade.xml")))
        _mount(root, arm).attach(turned)
        return root


def drawn_only(geom: Any) -> bool:
    """Return whether a geom of MJCF touches nothing."""
    return not any(int(inherited(geom, each, 1)) for each in ("contype", "conaffinity"))


def _with_gripper(arm: ArmFile, path: Path) -> Any:
    root = _arm(arm, path)
    gripper = root
    if arm.gripper.model is not None:
        gripper = _as_it_comes(located(arm.gripper.model, path.parent, arm.package), "gripper")
        _mount(root, arm).attach(gripper)
    add_gripper(arm.gripper, gripper)
    return root


def _arm(arm: ArmFile, path: Path) -> Any:
    """The arm without a tool, with servos like those of the project's own arm."""
    root = _as_it_comes(located(arm.arm, path.parent, arm.package), path.stem)
    if any(arm.base_m):
        for part in (*root.worldbody.body, *root.worldbody.geom):
            part.pos = np.array(arm.base_m) + _vector(part.pos)
    for told in arm.joints:
        joint = found(root, "joint", told.name)
        if told.armature_kg_m2 is not None:
            joint.armature = told.armature_kg_m2
        root.actuator.add(
            "intvelocity",
            name=told.name,
            joint=joint,
            kp=told.kp,
            kv=told.kp * told.lag_s,
            forcerange=[-told.force_n_m, told.force_n_m],
            ctrlrange=[-2 * told.speed_rad_s, 2 * told.speed_rad_s],
            actrange=inherited(joint, "range", (-4 * np.pi, 4 * np.pi)),
        )
    return root


def _as_it_comes(path: Path, name: str) -> Any:
    """A model, without what belongs to the scene that it was drawn for."""
    with _said_in_a_line(f"{path} is no MJCF that can be read"):
        root: Any = mjcf.from_path(str(path))
    root.model = name
    for kind in ("actuator", "sensor", "light", "camera"):
        for element in root.find_all(kind):
            element.remove()
    for part in (root.option, root.size, root.visual, root.statistic, root.keyframe):
        part.remove()
    drawn = [geom for geom in root.find_all("geom") if drawn_only(geom)]
    thin(root, drawn)
    for number, geom in enumerate(root.find_all("geom")):
        geom.name = geom.name or f"{getattr(geom.parent, 'name', None) or 'part'}_{number}"
        if drawn and not drawn_only(geom):
            geom.group = _COLLIDING
    for site in root.find_all("site"):
        site.group = _SITES
    for number, body in enumerate(root.find_all("body")):
        body.name = body.name or f"body_{number}"
        body.gravcomp = 1.0
    return root


def _mount(root: Any, arm: ArmFile) -> Any:
    site = root.find("site", arm.mount.at)
    if site is not None:
        return site
    return found(root, "body", arm.mount.at).add("site", name="tool_mount", group=_SITES)


@lru_cache(maxsize=8)
def _touching(path: Path) -> tuple[tuple[str, str], ...]:
    """The bodies, by name, whose shapes meet where the arm waits with its gripper open."""
    arm = read_arm(path)
    with _said_in_a_line(f"the arm of {path} does not compile"):
        root = _with_gripper(arm, path)
        physics = mjcf.Physics.from_mjcf_model(root)
    model, data = physics.model.ptr, physics.data.ptr
    for joint in arm.joints:
        data.joint(joint.name).qpos = joint.home_rad
    for name, value in open_positions(arm.gripper, root).items():
        data.joint(name).qpos = value
    mujoco.mj_forward(model, data)
    pairs = set[tuple[str, str]]()
    for contact in data.contact:
        if contact.dist < _FROM_M:
            bodies = model.geom_bodyid[contact.geom]
            first, second = sorted(int(body) for body in bodies)
            # What is fixed to the world has no name to except it by.
            if first > 0:
                pairs.add((model.body(first).name, model.body(second).name))
    return tuple(sorted(pairs))


@contextmanager
def _said_in_a_line(what: str) -> Iterator[None]:
    """Raise ParameterError for what dm_control and MuJoCo's compiler raise, of several kinds."""
    try:
        yield
    except SheathError:
        raise
    except Exception as error:
        raise ParameterError(f"{what}: {' '.join(str(error).split())}") from error


def _vector(value: Vector | None) -> np.ndarray:
    return np.zeros(3) if value is None else np.array(value, float)
