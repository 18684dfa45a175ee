"""Solids of triangles: what a camera sees of an asset, component by component."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Vector = tuple[float, float, float]

MAX_SPLITS = 16


class Component(StrEnum):
    """A part of an asset that an inspection reports on."""

    FOUNDATION = "foundation"
    PLATE = "plate"
    BODY = "body"
    HEAD = "head"
    CROSSARM = "crossarm"
    STRING = "string"  # of insulators
    CLAMP = "clamp"
    EARTH_WIRE_PEAK = "earth_wire_peak"
    GUY = "guy"
    WIRES = "wires"  # of one side of a span, up to its middle
    DECK = "deck"
    FACE = "face"  # one side of a bridge's deck
    UNDERSIDE = "underside"
    PIER = "pier"
    ABUTMENT = "abutment"  # its side under the deck


# Patches of these are larger, by this factor: there is much of them, and it looks the same.
COARSER = {Component.BODY: 1.5, Component.GUY: 2.0, Component.WIRES: 10.0, Component.DECK: 1.5, Component.UNDERSIDE: 1.5}


@dataclass(frozen=True, eq=False)
class Solid:
    """Triangles with outward normals; x east, y north, z up [m].

    triangles float64 (t, 3, 3); component (t,): place in `components`, which lists each part with its number: ("string", 3).
    """

    triangles: FloatArray
    component: IntArray
    components: tuple[tuple[Component, int], ...]

    def __len__(self) -> int:
        return len(self.triangles)

    def turned(self, bearing_deg: float) -> "Solid":
        """Turned clockwise, as seen from above, from x right of and y along a direction to that direction's bearing."""
        return Solid(self.triangles @ _turn(bearing_deg).T, self.component, self.components)

    def moved(self, by: Vector) -> "Solid":
        return Solid(self.triangles + np.array(by), self.component, self.components)

    @property
    def area_m2(self) -> float:
        corners = self.triangles
        return float(np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()) / 2.0

    @property
    def box(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest x, y, z [m]."""
        points = self.triangles.reshape(-1, 3)
        return points.min(axis=0), points.max(axis=0)


@dataclass(frozen=True, eq=False)
class Patches:
    """Small pieces of a solid's surface, of which each is seen or is not.

    corners float64 (p, 3, 3), centre, normal (p, 3) [m]; area_m2 (p,); component (p,) as of the solid.
    """

    corners: FloatArray
    centre: FloatArray
    normal: FloatArray
    area_m2: FloatArray
    component: IntArray

    def __len__(self) -> int:
        return len(self.centre)

    def only(self, rows: IntArray) -> "Patches":
        return Patches(self.corners[rows], self.centre[rows], self.normal[rows], self.area_m2[rows], self.component[rows])


class SolidBuilder:
    """Collects the parts of one asset."""

    def __init__(self) -> None:
        self._triangles: list[FloatArray] = []
        self._component: list[int] = []
        self._components: list[tuple[Component, int]] = []

    def part(self, component: Component) -> int:
        """Begin a further part of this kind; returns its place."""
        number = sum(kind is component for kind, _ in self._components)
        self._components.append((component, number))
        return len(self._components) - 1

    def faces(self, part: int, triangles: FloatArray) -> None:
        """Triangles (t, 3, 3), anticlockwise as seen from outside."""
        self._triangles.append(triangles)
        self._component += [part] * len(triangles)

    def prism(self, part: int, bottom: Sequence[Vector], top: Sequence[Vector]) -> None:
        """Between two polygons of as many corners, both anticlockwise as seen from the top's side; with both end faces."""
        low, high = np.array(bottom, dtype=np.float64), np.array(top, dtype=np.float64)
        count = len(low)
        faces = []
        for corner in range(count):
            after = (corner + 1) % count
            faces += [(low[corner], low[after], high[after]), (low[corner], high[after], high[corner])]
        for corner in range(1, count - 1):
            faces += [(high[0], high[corner], high[corner + 1]), (low[0], low[corner + 1], low[corner])]
        self.faces(part, np.array(faces))

    def beam(self, part: int, start: Vector, end: Vector, start_m: tuple[float, float], end_m: tuple[float, float] | None = None) -> None:
        """A bar with rectangular ends, start_m and end_m wide and high [m]; it stands upright where it is vertical."""
        begin, until = np.array(start), np.array(end)
        axis = (until - begin) / np.linalg.norm(until - begin)
        side = np.cross(axis, (0.0, 0.0, 1.0)) if abs(axis[2]) < 0.9 else np.array((1.0, 0.0, 0.0))
        side = side / np.linalg.norm(side)
        over = np.cross(side, axis)
        corners = ((-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0))

        def ring(place: FloatArray, size: tuple[float, float]) -> list[Vector]:
            return [tuple((place + side * (a * size[0] / 2.0) + over * (b * size[1] / 2.0)).tolist()) for a, b in corners]

        self.prism(part, ring(begin, start_m), ring(until, start_m if end_m is None else end_m))

    def box(self, part: int, low: Vector, high: Vector) -> None:
        corners = ((low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1]))
        self.prism(part, [(x, y, low[2]) for x, y in corners], [(x, y, high[2]) for x, y in corners])

    def frustum(self, part: int, low_m: float, high_m: float, low_half_m: float, high_half_m: float, at: Vector = (0.0, 0.0, 0.0)) -> None:
        """A square tapered column between two heights, with half widths there [m]."""
        corners = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
        self.prism(
            part,
            [(at[0] + x * low_half_m, at[1] + y * low_half_m, at[2] + low_m) for x, y in corners],
            [(at[0] + x * high_half_m, at[1] + y * high_half_m, at[2] + high_m) for x, y in corners],
        )

    def solid(self) -> Solid:
        triangles = np.concatenate(self._triangles) if self._triangles else np.zeros((0, 3, 3))
        return Solid(triangles, np.array(self._component, dtype=np.int64), tuple(self._components))


def patches_of(solid: Solid, size_m: float) -> Patches:
    """Divide the surface into triangles with sides no longer than size_m, times COARSER; degenerate triangles are dropped."""
    corners, number = solid.triangles, np.arange(len(solid))
    longest_m = size_m * np.array([COARSER.get(kind, 1.0) for kind, _ in solid.components])
    for _ in range(MAX_SPLITS):
        sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
        long = sides.max(axis=1) > longest_m[solid.component[number]]
        if not long.any():
            break
        longest = sides[long].argmax(axis=1)
        rows = np.arange(int(long.sum()))
        wide = corners[long]
        start, end, tip = wide[rows, longest], wide[rows, (longest + 1) % 3], wide[rows, (longest + 2) % 3]
        middle = (start + end) / 2.0
        halves = np.concatenate([np.stack([start, middle, tip], axis=1), np.stack([middle, end, tip], axis=1)])
        corners = np.concatenate([corners[~long], halves])
        number = np.concatenate([number[~long], number[long], number[long]])
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    twice_m2 = np.linalg.norm(across, axis=1)
    kept = twice_m2 > 1e-9
    return Patches(
        corners=corners[kept],
        centre=corners[kept].mean(axis=1),
        normal=across[kept] / twice_m2[kept][:, None],
        area_m2=twice_m2[kept] / 2.0,
        component=solid.component[number[kept]],
    )


def _turn(bearing_deg: float) -> FloatArray:
    """The matrix from x right, y along to x east, y north."""
    angle = np.radians(bearing_deg)
    return np.array([[np.cos(angle), np.sin(angle), 0.0], [-np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 1.0]])
