"""Bridges as solids: deck, faces, underside, piers and abutments, from the outline on the map and the likely height of the deck.

Piers stand at equal distances, as the 3D view draws them: map data do not state where they are. The ends of the deck, where the road or the
track goes on, are no part of the surface.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import shapely

from inspection.scene.bridges import ABUTMENT_INSET_M, PIER_EVERY_M, PIER_HALF_M, PIER_M, PIER_SHARE, SLAB_M
from planning.views.solids import Component, FloatArray, Solid, SolidBuilder

MIN_ROOM_M = 0.5  # below the slab, for a pier to be seen
END_COSINE = 0.7  # between the outward normal of an end and the axis
PIECE_M = 25.0  # of the outline along the axis
MIN_STRIP_M = 4.0  # of the deck along the axis, for its triangles
ANCHOR_EVERY_M = 12.0


@dataclass(frozen=True, eq=False)
class BridgeShape:
    """A bridge on the map. parts: polygons in metres east and north of its middle; deck_m: of the level deck over the ground there.

    top_m: as high as planners count it; ground_m: of places (n, 2), over that in the middle [m], known everywhere. outline_error_m: by
    which the real outline may be beside parts.
    """

    parts: tuple[shapely.Polygon, ...]
    deck_m: float
    top_m: float
    ground_m: Callable[[FloatArray], FloatArray]
    outline_error_m: float = 0.0

    @cached_property
    def decks(self) -> tuple["_Deck", ...]:
        return tuple(_Deck(part, _long_side(part)) for part in self.parts)

    @property
    def bearing_deg(self) -> float:
        """Of the axis of its largest part."""
        along = max(self.decks, key=lambda deck: deck.outline.area).along
        return float(np.degrees(np.arctan2(along[0], along[1])) % 180.0)

    @property
    def length_m(self) -> float:
        return max(deck.to_m - deck.from_m for deck in self.decks)

    @property
    def width_m(self) -> float:
        """The mean width of its parts together."""
        return sum(deck.outline.area for deck in self.decks) / self.length_m

    @property
    def piers(self) -> int:
        return sum(1 for deck in self.decks for wall in deck.walls() if not wall.is_end and self._room_m(wall) > MIN_ROOM_M)

    @property
    def reach_m(self) -> float:
        """From its middle to its farthest corner."""
        corners = np.concatenate([shapely.get_coordinates(part.exterior) for part in self.parts])
        return float(np.linalg.norm(corners, axis=1).max())

    def anchors(self) -> FloatArray:
        """Places (n, 2) along the axis of each part, ANCHOR_EVERY_M apart."""
        return np.concatenate([deck.anchors() for deck in self.decks])

    def pieces(self) -> Iterator[FloatArray]:
        """The outline, cut across its axis every PIECE_M: corners (n, 2) of pieces whose convex hulls cover it."""
        for deck in self.decks:
            yield from (shapely.get_coordinates(piece) for piece in deck.pieces())

    def solid(self) -> Solid:
        builder, low_m = SolidBuilder(), self.deck_m - SLAB_M
        for deck in self.decks:
            flat = deck.triangles()
            self._add(builder, Component.DECK, _at(flat, self.deck_m))
            self._add(builder, Component.UNDERSIDE, _at(flat, low_m)[:, ::-1])
            for side in deck.sides():
                self._add(builder, Component.FACE, np.concatenate([_wall(*edge, low_m, self.deck_m) for edge in side]))
            for wall in deck.walls():
                if self._room_m(wall) > MIN_ROOM_M:
                    part = builder.part(Component.ABUTMENT if wall.is_end else Component.PIER)
                    foot_m = low_m - self._room_m(wall)
                    builder.faces(part, np.concatenate([_wall(*edge, foot_m, low_m) for edge in wall.edges()]))
        return builder.solid()

    def _add(self, builder: SolidBuilder, component: Component, triangles: FloatArray) -> None:
        """Add what is above the ground of it: an end of the slab may be in the bank."""
        middle = triangles.mean(axis=1)
        above = triangles[middle[:, 2] >= self.ground_m(middle[:, :2])]
        if len(above):
            builder.faces(builder.part(component), above)

    def _room_m(self, wall: "_Wall") -> float:
        return self.deck_m - SLAB_M - float(self.ground_m(wall.corners).min())


@dataclass(frozen=True, eq=False)
class _Wall:
    """What carries the deck: its four corners anticlockwise; of an abutment the first two face the open side."""

    corners: FloatArray
    is_end: bool

    def edges(self) -> list[tuple[FloatArray, FloatArray]]:
        """The edges, outside on the right; of an abutment that to the open side."""
        closed = np.vstack([self.corners, self.corners[:1]])
        edges = list(pairwise(closed))
        return edges[:1] if self.is_end else edges


@dataclass(frozen=True, eq=False)
class _Deck:
    """One polygon of a bridge, anticlockwise, with the direction (2,) of its axis."""

    outline: shapely.Polygon
    along: FloatArray

    @property
    def across(self) -> FloatArray:
        return np.array([-self.along[1], self.along[0]])

    @cached_property
    def middle(self) -> FloatArray:
        return np.array(self.outline.centroid.coords[0])

    @cached_property
    def reaches_m(self) -> tuple[float, float]:
        along_m = (shapely.get_coordinates(self.outline.exterior) - self.middle) @ self.along
        return float(along_m.min()), float(along_m.max())

    @property
    def from_m(self) -> float:
        return self.reaches_m[0]

    @property
    def to_m(self) -> float:
        return self.reaches_m[1]

    def at(self, along_m: float, across_m: float) -> FloatArray:
        place: FloatArray = self.middle + self.along * along_m + self.across * across_m
        return place

    def widths_m(self, along_m: float) -> tuple[float, float] | None:
        """Between which distances across the axis the outline is there; None where it is not."""
        far_m = 2.0 * (self.to_m - self.from_m)
        cut = shapely.LineString([self.at(along_m, -far_m), self.at(along_m, far_m)]).intersection(self.outline)
        if cut.is_empty:
            return None
        across_m = (shapely.get_coordinates(cut) - self.middle) @ self.across
        return float(across_m.min()), float(across_m.max())

    def anchors(self) -> FloatArray:
        count = max(math.ceil((self.to_m - self.from_m) / ANCHOR_EVERY_M), 1)
        found = []
        for along_m in (self.from_m + (np.arange(count) + 0.5) / count * (self.to_m - self.from_m)).tolist():
            sides_m = self.widths_m(along_m)
            if sides_m is not None:
                found.append(self.at(along_m, sum(sides_m) / 2.0))
        return np.array(found).reshape(-1, 2)

    def pieces(self, piece_m: float = PIECE_M) -> Iterator[shapely.Polygon]:
        """The outline, cut across the axis about every piece_m."""
        far_m = 2.0 * (self.to_m - self.from_m)
        count = max(math.ceil((self.to_m - self.from_m) / piece_m), 1)
        for low_m, high_m in pairwise(np.linspace(self.from_m - 0.01, self.to_m + 0.01, count + 1).tolist()):
            strip = shapely.Polygon([self.at(low_m, -far_m), self.at(high_m, -far_m), self.at(high_m, far_m), self.at(low_m, far_m)])
            for piece in shapely.get_parts(self.outline.intersection(strip)):
                if piece.area > 0.0:
                    yield piece

    def triangles(self) -> FloatArray:
        """The outline in triangles (t, 3, 2), anticlockwise, none of them much longer than the deck is wide."""
        wide_m = max(self.outline.area / (self.to_m - self.from_m), MIN_STRIP_M)
        found = np.concatenate([shapely.get_parts(shapely.constrained_delaunay_triangles(own)) for own in self.pieces(wide_m)])
        corners = np.array([shapely.get_coordinates(shapely.get_exterior_ring(own))[:3] for own in found]).reshape(-1, 3, 2)
        one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        is_left = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0] > 0.0
        return np.where(is_left[:, None, None], corners, corners[:, ::-1])

    def sides(self) -> Iterator[list[tuple[FloatArray, FloatArray]]]:
        """The edges of the left and of the right side along the axis, outside on the right; ends are left out."""
        left: list[tuple[FloatArray, FloatArray]] = []
        right: list[tuple[FloatArray, FloatArray]] = []
        half_m = float(self.outline.area) / (self.to_m - self.from_m)
        for ring in (self.outline.exterior, *self.outline.interiors):
            for start, end in pairwise(shapely.get_coordinates(ring)):
                length_m = float(np.linalg.norm(end - start))
                if length_m == 0.0:
                    continue
                normal = np.array([end[1] - start[1], start[0] - end[0]]) / length_m
                at_m = float(((start + end) / 2.0 - self.middle) @ self.along)
                is_near_end = min(at_m - self.from_m, self.to_m - at_m) <= half_m
                if is_near_end and abs(float(normal @ self.along)) > END_COSINE:
                    continue
                (left if float(normal @ self.across) > 0.0 else right).append((start, end))
        yield from (side for side in (left, right) if side)

    def walls(self) -> Iterator[_Wall]:
        """Abutments at both ends, and piers between them."""
        from_m, to_m = self.from_m + ABUTMENT_INSET_M, self.to_m - ABUTMENT_INSET_M
        if to_m - from_m < 4.0 * ABUTMENT_INSET_M:
            return
        fields = max(round((to_m - from_m) / PIER_EVERY_M), 1)
        for field in range(fields + 1):
            at_m = from_m + (to_m - from_m) * field / fields
            sides_m = self.widths_m(at_m)
            if sides_m is None:
                continue
            is_end = field in {0, fields}
            middle_m, half_m = sum(sides_m) / 2.0, (sides_m[1] - sides_m[0]) / 2.0
            half_m = half_m if is_end else min(half_m * PIER_SHARE, PIER_HALF_M)
            open_m = PIER_M / 2.0 * (-1.0 if field == fields else 1.0)
            corners = ((open_m, -half_m), (open_m, half_m), (-open_m, half_m), (-open_m, -half_m))
            if open_m < 0.0:
                corners = (corners[1], corners[0], corners[3], corners[2])
            yield _Wall(np.array([self.at(at_m + along_m, middle_m + across_m) for along_m, across_m in corners]), is_end)


def _long_side(outline: shapely.Polygon) -> FloatArray:
    """The direction (2,) of the longer side of the smallest rectangle around it."""
    corners = shapely.get_coordinates(shapely.oriented_envelope(outline))
    sides = np.diff(corners[:3], axis=0)
    length_m = np.linalg.norm(sides, axis=1)
    longest: FloatArray = sides[length_m.argmax()] / length_m.max()
    return longest


def _at(flat: FloatArray, height_m: float) -> FloatArray:
    return np.concatenate([flat, np.full((*flat.shape[:2], 1), height_m)], axis=2)


def _wall(start: FloatArray, end: FloatArray, low_m: float, high_m: float) -> FloatArray:
    """Triangles (t, 3, 3) over an edge whose outside is on the right, seen from start to end; about as long as they are high."""
    count = max(math.ceil(float(np.linalg.norm(end - start)) / (high_m - low_m)), 1)
    places = start + (end - start) * np.linspace(0.0, 1.0, count + 1)[:, None]
    feet, tops = (np.column_stack([places, np.full(count + 1, height_m)]) for height_m in (low_m, high_m))
    lower, upper = np.stack([feet[:-1], feet[1:], tops[1:]], axis=1), np.stack([feet[:-1], tops[1:], tops[:-1]], axis=1)
    return np.concatenate([lower, upper])
