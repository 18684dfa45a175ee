"""Photos of the wires at a tower: from both sides of its line, with overlap, up to the middle of each span.

A wire hangs somewhere between its coldest and its hottest arc, so photos show that whole band. Its surface stands on the axis of the span,
facing to both sides: from each side the wires up to the axis are at least as fine as asked for.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from planning.views.camera import Camera, footprint_m, standoff_m
from planning.views.detail_views import MAX_PHOTOS, TooManyPhotos
from planning.views.ground_band import GroundBand
from planning.views.keep_out import KeepOut
from planning.views.proof import REACH_M
from planning.views.site import InspectionSite, WireBand
from planning.views.solids import Component, FloatArray, Solid
from planning.views.visibility import FRAME_MARGIN, Poses, axes_of

OVERLAP = 0.3  # of neighbouring photos along the span, and of one above the other
PITCHES_DEG = (-10.0, -20.0, 0.0, -30.0, 10.0, -40.0, -50.0)  # the first that heights and what stands there allow
DISTANCE_SHARES = (1.0, 0.8, 0.6, 0.45)  # of the farthest distance; the first at which a photo has a place
LENS_MARGIN_M = 1.0  # beyond the clearance: where a focal length has to reach the ground sample distance
DISTANCE_MARGIN = 0.97  # share of the farthest distance that is used, for errors of position
MAX_HALF_SPAN_M = 500.0  # of a span, up to where its wires are photographed
SKIPPED_M = 3.0  # along the span, where there is no place for a photo
PIECE_M = 10.0  # of the surface
LOWEST_M = 4.0  # above the ground, of wires at their hottest
MAX_ROWS = 50  # of photos above one another


@dataclass(frozen=True)
class _Side:
    """One side of a span: its direction (2,), and the one in which photos are taken, to the axis from there."""

    band: WireBand
    along: FloatArray
    inward: FloatArray
    ground: GroundBand

    @property
    def yaw_deg(self) -> float:
        return math.degrees(math.atan2(self.inward[0], self.inward[1])) % 360.0

    def on_axis(self, along_m: float, height_m: float) -> FloatArray:
        return np.array([*(np.array(self.band.span.start) + self.along * along_m), height_m])

    @property
    def middle_m(self) -> float:
        return min(self.band.length_m / 2.0, MAX_HALF_SPAN_M)

    def heights_m(self, along_m: float) -> tuple[float, float]:
        """Between which heights wires are so far along the span, at least LOWEST_M over the ground where they are not fastened lower."""
        low_m, high_m = self.band.heights_m(along_m)
        fastened_m = min(self.band.start_low_m, self.band.end_low_m)
        over_ground_m = self.ground.ground_m(self.on_axis(along_m, 0.0)[:2]) + LOWEST_M
        return max(low_m, min(over_ground_m, fastened_m)), high_m

    def extremes_m(self, from_m: float, to_m: float) -> tuple[float, float]:
        """The lowest and the highest wire between two places on the half of the span at the tower."""
        places_m = np.clip(np.linspace(from_m, to_m, 5), 0.0, self.middle_m)
        heights_m = np.array([self.heights_m(along_m) for along_m in places_m.tolist()])
        return float(heights_m[:, 0].min()), float(heights_m[:, 1].max())


def sides_of(site: InspectionSite) -> Iterator[_Side]:
    """Yield left and right side of each span, as seen from the tower."""
    for band in site.bands:
        along = (np.array(band.span.end) - np.array(band.span.start)) / band.length_m
        for turn in (1.0, -1.0):
            yield _Side(band, along, turn * np.array([along[1], -along[0]]), site.keep_out.band)


def wires_solid(site: InspectionSite) -> Solid:
    """Return the surfaces that stand for the wires: one of each side of each span, from the tower to the middle, facing outwards.

    It is no closed body, and hides nothing.
    """
    triangles: list[FloatArray] = []
    component: list[int] = []
    sides = list(sides_of(site))
    for number, side in enumerate(sides):
        cuts_m = np.linspace(0.0, side.middle_m, math.ceil(side.middle_m / PIECE_M) + 1).tolist()
        edges = [[side.on_axis(along_m, height_m) for height_m in side.heights_m(along_m)] for along_m in cuts_m]
        for (low, high), (next_low, next_high) in pairwise(edges):
            pair = np.array([(low, next_low, next_high), (low, next_high, high)])
            normal = np.cross(pair[0, 1] - pair[0, 0], pair[0, 2] - pair[0, 0])
            triangles.append(pair[:, ::-1] if normal[:2] @ side.inward > 0.0 else pair)
            component += [number] * 2
    found = np.concatenate(triangles) if triangles else np.zeros((0, 3, 3))
    return Solid(found, np.array(component, dtype=np.int64), tuple((Component.WIRES, number) for number in range(len(sides))))


@dataclass(frozen=True, eq=False)
class SpanPhotos:
    """distance_m (n,): along each optical axis to the axis of the span."""

    poses: Poses
    distance_m: FloatArray
    focal_mm: float


def span_photos(site: InspectionSite, camera: Camera, asked_gsd_m: float) -> SpanPhotos:
    """Return photos of both sides of each half span; none where no place is allowed. Raises TooManyPhotos."""
    focal_mm = _focal_mm(site, camera, asked_gsd_m)
    farthest_m = DISTANCE_MARGIN * min(standoff_m(camera, asked_gsd_m, focal_mm), REACH_M)
    found: list[tuple[float, ...]] = []
    if farthest_m > max(camera.nearest_focus_m, site.clearance_m):
        for side in sides_of(site):
            for pose in _Pass(side, site.keep_out, camera, focal_mm, farthest_m).poses():
                found.append(pose)
                if len(found) > MAX_PHOTOS:
                    raise TooManyPhotos
    values = np.array(found).reshape(-1, 6)
    return SpanPhotos(Poses(values[:, :3], values[:, 3], values[:, 4]), values[:, 5], focal_mm)


def _focal_mm(site: InspectionSite, camera: Camera, asked_gsd_m: float) -> float:
    """The shortest focal length that reaches the ground sample distance from outside of the clearance, else the longest."""
    needed_m = max((_outside_m(side, site.keep_out) for side in sides_of(site)), default=0.0) + LENS_MARGIN_M
    level_share = math.cos(math.radians(PITCHES_DEG[0]))
    for focal_mm in camera.focal_lengths_mm:
        if DISTANCE_MARGIN * level_share * min(standoff_m(camera, asked_gsd_m, focal_mm), REACH_M) >= needed_m:
            return focal_mm
    return camera.focal_lengths_mm[-1]


def _outside_m(side: _Side, keep_out: KeepOut) -> float:
    """How far from the axis the clearance of the wires ends in the middle of the span, where they swing the most; at most REACH_M."""
    middle_m = side.middle_m
    away_m = np.arange(0.0, REACH_M, 0.5)
    low_m, _ = side.heights_m(middle_m)
    places = side.on_axis(middle_m, low_m) - away_m[:, None] * np.append(side.inward, 0.0)
    clear = np.flatnonzero(~keep_out.in_column(places))
    return float(away_m[clear[0]]) if len(clear) else REACH_M


@dataclass(frozen=True)
class _Pass:
    """Photos along one side."""

    side: _Side
    keep_out: KeepOut
    camera: Camera
    focal_mm: float
    farthest_m: float

    def poses(self) -> Iterator[tuple[float, ...]]:
        """Yield position [m], yaw and pitch [deg] and distance [m] of each photo, from the tower to the middle, row by row there."""
        shown_m = 0.0
        while shown_m < self.side.middle_m:
            wide_m, column = self._column(shown_m, self._wide(self.farthest_m))
            if column:  # a nearer place shows less, so it has to be less far along
                nearer_m, nearer = self._column(shown_m, wide_m)
                wide_m, column = (nearer_m, nearer) if nearer else (wide_m, column)
            yield from column
            shown_m += wide_m * (1.0 - OVERLAP) if column else SKIPPED_M

    def _wide(self, away_m: float) -> float:
        return footprint_m(self.camera, away_m, self.focal_mm)[0] * (1.0 - 2.0 * FRAME_MARGIN)

    def _high(self, away_m: float) -> float:
        return footprint_m(self.camera, away_m, self.focal_mm)[1] * (1.0 - 2.0 * FRAME_MARGIN)

    def _column(self, shown_m: float, wide_m: float) -> tuple[float, list[tuple[float, ...]]]:
        """How wide the photos show the span that are taken for about such a width from here on, and those photos; none: no place."""
        at_m = min(shown_m + wide_m * (0.5 - OVERLAP / 2.0), self.side.middle_m)
        low_m, high_m = self.side.extremes_m(at_m - wide_m / 2.0, at_m + wide_m / 2.0)
        best_share, best = 0.0, (wide_m, list[tuple[float, ...]]())
        for share in DISTANCE_SHARES:
            rows, found = self._stacked(at_m, low_m, high_m, share * self.farthest_m)
            if len(found) / rows > best_share:
                best_share, best = len(found) / rows, (self._wide(min(pose[-1] for pose in found)), found)
            if best_share == 1.0:
                break
        return best

    def _stacked(self, at_m: float, low_m: float, high_m: float, away_m: float) -> tuple[int, list[tuple[float, ...]]]:
        """How many photos above one another show these heights from so far away, and those that there is a place for."""
        row_m = self._high(away_m)
        rows = max(1, math.ceil((high_m - low_m - row_m) / (row_m * (1.0 - OVERLAP))) + 1)
        if rows > MAX_ROWS:
            raise TooManyPhotos
        half_m = min(row_m, high_m - low_m) / 2.0
        gimbal = self.camera.gimbal
        pitches_deg = np.array([own for own in PITCHES_DEG if gimbal.pitch_min_deg <= own <= gimbal.pitch_max_deg])
        slant_m = away_m - half_m * np.abs(np.sin(np.radians(pitches_deg)))  # what is far off the optical axis is farther away
        _, _, forward = axes_of(np.full(len(pitches_deg), self.side.yaw_deg), pitches_deg)
        aims = np.array([self.side.on_axis(at_m, height_m) for height_m in np.linspace(low_m + half_m, high_m - half_m, rows).tolist()])
        places = aims[:, None, :] - (forward * slant_m[:, None])[None, :, :]
        free = ~self.keep_out.holds(places.reshape(-1, 3)).reshape(rows, len(pitches_deg)) & (slant_m >= self.camera.nearest_focus_m)
        return rows, [
            (*places[row, first].tolist(), self.side.yaw_deg, float(pitches_deg[first]), float(slant_m[first]))
            for row in np.flatnonzero(free.any(axis=1)).tolist() for first in [int(free[row].argmax())]
        ]  # fmt: skip
