"""The ground that judges of plans know: hills by another interpolation, and what stands on it by the rows of the database."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from django.contrib.gis.db.models import Extent
from scipy.interpolate import RegularGridInterpolator

from inspection.models import Asset
from inspection.services import import_terrain
from tests.inspection.importers.terrain.tiffs import write_geotiff
from tests.missions.plane import EARTH_M, apart_m

CLEARANCE_M = 15.0
TALLEST_M = 105.0  # what can be flown over
HEIGHT_M = 1.0  # what heights may differ by
STRAY_M = 10.1  # of the 10 m that a leg may be off the straight line between the heights of its waypoints; the rest is rounding
LOWEST_M, HIGHEST_M = 59.4, 120.1  # between targets, where nothing is inspected from lower
SPACING_M = 5.0


class Hills:
    """Rolling ground between 100 m and 500 m above the sea under all of a region."""

    def __init__(self) -> None:
        west, south, east, north = Asset.objects.aggregate(extent=Extent("centre"))["extent"]
        posts = 500
        self.step = max(east - west, north - south, 0.5) * 1.4 / posts
        across, down = np.meshgrid(np.arange(posts), np.arange(posts))
        self.heights = (300 + 120 * np.sin(across / 9.0) + 80 * np.cos(down / 13.0)).astype("f4")
        self.corner = (west + east - self.step * posts) / 2, (south + north + self.step * posts) / 2
        rows = self.corner[1] - (np.arange(posts) + 0.5) * self.step
        columns = self.corner[0] + (np.arange(posts) + 0.5) * self.step
        self.at = RegularGridInterpolator((rows[::-1], columns), self.heights[::-1].astype(float))
        self.steepest = float(max(np.abs(np.diff(self.heights, axis=axis)).max() for axis in (0, 1))) * 1.5 / (self.step * 60_000.0)

    def bring_in(self, path: Path) -> None:
        import_terrain(path=write_geotiff(path, self.heights, srid=9707, origin=self.corner, step=self.step))

    def metres(self, places: Any) -> Any:
        """Above the sea, (n,), under places (n, 2)."""
        return self.at(np.asarray(places)[:, ::-1])


def along(start: Any, end: Any) -> Any:
    """Places on the straight line from one to the other, (n, 2), and how far each is, as a share of it."""
    shares = np.linspace(0.0, 1.0, max(2, int(apart_m(start, end) / SPACING_M) + 2))
    return np.asarray(start) + shares[:, None] * (np.asarray(end) - np.asarray(start)), shares


def wrong_heights(plan: dict[str, Any], hills: Hills | None) -> Iterator[str]:
    """Waypoints that are not as high above the ground as they say, and ground that bulges between them."""
    for route in plan["routes"]:
        points = route["waypoints"]
        if not points:
            continue
        if hills is None:
            if any(point["altitude_amsl_m"] is not None for point in points):
                yield f"{route['uav']} knows of ground that nobody knows"
            continue
        if any(point["altitude_amsl_m"] is None for point in points):
            yield f"{route['uav']} does not know the ground"
            continue
        places = np.array([point["position"] for point in points])
        amsl_m, agl_m, relative_m = (np.array([point[f"altitude_{over}_m"] for point in points]) for over in ("amsl", "agl", "relative"))
        ground_m = hills.metres(places)
        if (np.abs(amsl_m - agl_m - ground_m) > HEIGHT_M).any() or (np.abs(amsl_m - relative_m - ground_m[0]) > HEIGHT_M).any():
            yield f"{route['uav']} is not as high above the ground as it says"
        for leg in range(len(points) - 1):
            under, shares = along(places[leg], places[leg + 1])
            above_m = amsl_m[leg] + shares * (amsl_m[leg + 1] - amsl_m[leg]) - hills.metres(under)
            if (np.abs(above_m - agl_m[leg] - shares * (agl_m[leg + 1] - agl_m[leg])) > STRAY_M).any():
                yield f"the ground bulges under {route['uav']} after waypoint {leg}"
            if min(agl_m[leg], agl_m[leg + 1]) > 60.0 - HEIGHT_M and above_m.min() < LOWEST_M:
                yield f"{route['uav']} is {above_m.min():.1f} m above ground after waypoint {leg}"
            if above_m.max() > HIGHEST_M:
                yield f"{route['uav']} is {above_m.max():.1f} m above ground after waypoint {leg}"


class TallThings:
    """Towers that stick out above what is cleared between targets, in metres of a plane."""

    def __init__(self) -> None:
        rows = list(Asset.objects.filter(kind="tower", vanished_at=None, height_m__gt=45.0).values_list("centre", "height_m"))
        self.places = np.array([centre.coords for centre, _ in rows]).reshape(-1, 2)
        self.heights = np.array([height_m for _, height_m in rows])
        self.origin = self.places.mean(axis=0) if rows else np.zeros(2)
        self.tree = shapely.STRtree(shapely.points(self.metres(self.places)))

    def metres(self, places: Any) -> Any:
        degree_m = np.radians(1.0) * EARTH_M
        return (np.asarray(places) - self.origin) * (degree_m * np.cos(np.radians(self.origin[1])), degree_m)

    def tallest_m(self, course: Any) -> float:
        """Of what stands on a course in lon/lat."""
        on = self.tree.query(shapely.transform(course, self.metres), predicate="dwithin", distance=5.0)
        return float(self.heights[on].max(initial=0.0))

    def beside(self, start: Any, end: Any, beside_m: float) -> Any:
        """Their numbers."""
        return self.tree.query(shapely.linestrings(self.metres([start, end])), predicate="dwithin", distance=beside_m)
