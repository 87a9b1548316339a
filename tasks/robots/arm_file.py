"""An arm as a file describes it: where its model is, its joints, its gripper."""

import tomllib
from pathlib import Path

import msgspec

from sheath_manip.exceptions import ParameterError
from sheath_manip.tasks.assets import assets_of

FOLDER = assets_of("robots")
SUFFIX = ".toml"
Vector = tuple[float, float, float]


class _Part(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A part of the file; what it does not know is a mistake in writing."""


class Source(_Part, frozen=True):
    """A package that ships models."""

    package: str
    """as package registries call it"""
    folder: str
    """that models' paths start from: an importable name, then folders, as in `robosuite/models`"""
    install: str
    """what to type where it is missing"""
    menagerie: bool = False
    """whether mujoco_menagerie has the same files in the same places"""


class ArmJoint(_Part, frozen=True):
    """A joint of the arm, with the servo that moves it."""

    name: str
    home_rad: float
    speed_rad_s: float
    """at most"""
    kp: float
    """of the servo, N m/rad"""
    force_n_m: float
    """of the servo, at most"""
    lag_s: float = 0.03
    """by which the joint follows its servo's target: kv / kp"""
    armature_kg_m2: float | None = None
    """in the place of the model's"""


class Mount(_Part, frozen=True):
    """Where tools are fixed to the arm."""

    at: str
    """a site of the arm's model, or a body"""
    approach: Vector = (0.0, 0.0, 1.0)
    """the way that a tool points, in the frame of `at`"""
    across: Vector = (0.0, 1.0, 0.0)


class Rectangle(_Part, frozen=True):
    """What stands between objects when the gripper points down, around its approach."""

    half_along_m: float
    half_across_m: float
    above_tool_m: float


class Gripper(_Part, frozen=True):
    """What opens and closes; its model's own, or a part of the arm's."""

    body: str
    """that the tool's site is fixed to"""
    pinch_m: Vector
    """the tool's site: between the pads, in the frame of `body`"""
    joints: dict[str, float]
    """of the fingers, with their signs in the coordinate that the servo moves"""
    closed_m: tuple[tuple[float, float], ...]
    """coordinate and how far the gripper is closed (m), from open to closed"""
    kp: float
    """of the servo, N or N m a unit of the coordinate"""
    force: float
    """of the servo, at most"""
    tip_m: float
    """how far the finger tips stand out before the pinch"""
    depth_m: float
    """how much of an object has room behind the pinch"""
    footprints: tuple[Rectangle, ...]
    model: str | None = None
    lag_s: float = 0.05
    approach: Vector = (0.0, 0.0, 1.0)
    """the way that it points, in the frame of `body`"""
    across: Vector = (0.0, 1.0, 0.0)
    """the way that the fingers move"""
    pads: tuple[str, ...] = ()
    """geoms that hold: with four directions of friction, or else an object slips out of them"""
    pad_friction: float = 1.2
    abreast: bool = False
    """hold two fingers abreast, where nothing in the model does"""
    armature: float | None = None
    """of its joints, in the place of the model's"""
    damping: float | None = None
    camera_m: Vector = (-0.15, 0.0, 0.07)
    """the wrist's camera in the frame of the tool: approach, across, and their product"""


class ArmFile(_Part, frozen=True):
    """An arm."""

    title: str
    licence: str
    arm: str
    """the model, in MJCF: beside this file, in MENAGERIE_ROOT, or in the package"""
    joints: tuple[ArmJoint, ...]
    mount: Mount
    gripper: Gripper
    package: Source | None = None
    base_m: Vector = (0.0, 0.0, 0.0)
    """of the arm's foot, on the table at height 0"""
    guarded: tuple[str, ...] = ()
    """bodies to keep off objects; those behind the second joint where none are named"""


def read_arm(path: Path) -> ArmFile:
    """Return the arm that a file describes; raises ParameterError."""
    try:
        told = tomllib.loads(path.read_text())
    except OSError as error:
        raise ParameterError(
            f"no arm in {path}: {error.strerror}; wanted a file like those in {FOLDER}"
        ) from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ParameterError(f"{path} is no TOML: {error}") from error
    try:
        arm = msgspec.convert(told, ArmFile)
    except msgspec.ValidationError as error:
        raise ParameterError(f"{path} describes no arm: {error}") from error
    if not 1 <= len(arm.gripper.joints) <= 2 or not arm.joints:
        raise ParameterError(
            f"{path} has {len(arm.joints)} joints and a gripper of {len(arm.gripper.joints)}; "
            "wanted one joint or more, and a gripper of one or two"
        )
    return arm


def house_arms() -> tuple[str, ...]:
    """Return the names of the arms whose files come with this project."""
    return tuple(sorted(path.stem for path in FOLDER.glob(f"*{SUFFIX}")))


def path_of(arm: str) -> Path:
    """Return the file of an arm: that of a name among `house_arms`, or a path of one's own."""
    return Path(arm) if arm.endswith(SUFFIX) else FOLDER / f"{arm}{SUFFIX}"
