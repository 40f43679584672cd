"""One place or direction of the world; `maths.vectors` has arrays of them, which pay off from a dozen on."""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt

from rigtri.maths.vectors import unit_of


class Vector:
    """Three numbers, in file units where they are a place; nothing raises for inf and NaN."""

    __slots__ = ("x", "y", "z")

    def __init__(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> None:
        self.x, self.y, self.z = x, y, z

    def __iter__(self) -> Iterator[float]:
        return iter((self.x, self.y, self.z))

    def __add__(self, other: Vector) -> Vector:
        return Vector(self.x + other.x, self.y + other.y, self.z + other.z)

    def __sub__(self, other: Vector) -> Vector:
        return Vector(self.x - other.x, self.y - other.y, self.z - other.z)

    def __mul__(self, factor: float) -> Vector:
        return Vector(self.x * factor, self.y * factor, self.z * factor)

    def __neg__(self) -> Vector:
        return Vector(-self.x, -self.y, -self.z)

    def dot(self, other: Vector) -> float:
        return self.x * other.x + self.y * other.y + self.z * other.z

    def cross(self, other: Vector) -> Vector:
        return Vector(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )

    @property
    def length(self) -> float:
        return sqrt(self.x * self.x + self.y * self.y + self.z * self.z)

    def distance(self, other: Vector) -> float:
        """How far apart two places are: the length of their difference."""
        x, y, z = self.x - other.x, self.y - other.y, self.z - other.z
        return sqrt(x * x + y * y + z * z)

    @property
    def unit(self) -> Vector:
        """The same direction with length 1; zero where there is none.

        >>> list(Vector(0, 3, 4).unit), any(Vector().unit)
        ([0.0, 0.6, 0.8], False)
        """
        return Vector(*(unit_of((self.x, self.y, self.z)) or ()))
