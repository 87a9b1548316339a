"""The standing objects: their shapes, masses and what they stand like."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

_NECK_RADIUS = 0.42
"""of a bottle, as a share of its radius"""
_NECK_START = 0.66
"""of a bottle, as a share of its height"""


class Kind(StrEnum):
    """A kind of object."""

    CAN = "can"
    BOTTLE = "bottle"
    BOX = "box"


@dataclass(frozen=True)
class Cuboid:
    """A homogeneous part of an object: a cylinder or a box along the object's axis."""

    half_x_m: float
    half_y_m: float
    bottom_m: float
    top_m: float
    round: bool

    @property
    def volume_m3(self) -> float:
        """The volume of the object."""
        area = np.pi if self.round else 4.0
        return area * self.half_x_m * self.half_y_m * (self.top_m - self.bottom_m)

    @property
    def centre_m(self) -> float:
        """Height of its centre."""
        return (self.bottom_m + self.top_m) / 2

    @property
    def half_height_m(self) -> float:
        """Half of its height."""
        return (self.top_m - self.bottom_m) / 2

    def inertia_per_kg(self) -> NDArray[np.float64]:
        """(3,) about its centre, m²."""
        ratio = 4.0 if self.round else 3.0
        squares = np.array([self.half_x_m**2, self.half_y_m**2]) / ratio
        height = self.half_height_m**2 / 3
        return np.array([squares[1] + height, squares[0] + height, squares.sum()])


@dataclass(frozen=True)
class StandingObject:
    """An object on the table."""

    kind: Kind
    half_x_m: float
    """the radius of a can or bottle"""
    half_y_m: float
    height_m: float
    mass_kg: float
    x_m: float
    y_m: float
    yaw_rad: float
    rgba: tuple[float, float, float, float]

    @property
    def parts(self) -> tuple[Cuboid, ...]:
        """The parts, of one density each, from the bottom up."""
        round_ = self.kind is not Kind.BOX
        if self.kind is not Kind.BOTTLE:
            return (Cuboid(self.half_x_m, self.half_y_m, 0.0, self.height_m, round_),)
        start = _NECK_START * self.height_m
        neck = _NECK_RADIUS * self.half_x_m
        return (
            Cuboid(self.half_x_m, self.half_y_m, 0.0, start, round_),
            Cuboid(neck, neck, start, self.height_m, round_),
        )

    @property
    def centre_of_mass_m(self) -> float:
        """The height of the centre of mass."""
        volumes = [part.volume_m3 for part in self.parts]
        centres = [part.centre_m for part in self.parts]
        return float(np.average(centres, weights=volumes))

    @property
    def inertia_kg_m2(self) -> NDArray[np.float64]:
        """(3,) about its centre of mass."""
        total = sum(part.volume_m3 for part in self.parts)
        inertia = np.zeros(3)
        for part in self.parts:
            mass = self.mass_kg * part.volume_m3 / total
            away = (part.centre_m - self.centre_of_mass_m) ** 2
            inertia += mass * (part.inertia_per_kg() + np.array([away, away, 0.0]))
        return inertia

    @property
    def tip_angle_rad(self) -> float:
        """The tilt from which it falls over on its own, in the direction where it does first."""
        return float(np.arctan2(min(self.half_x_m, self.half_y_m), self.centre_of_mass_m))

    @property
    def reach_m(self) -> float:
        """The radius of the circle around its foot."""
        if self.kind is Kind.BOX:
            return float(np.hypot(self.half_x_m, self.half_y_m))
        return self.half_x_m
