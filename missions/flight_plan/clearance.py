"""The last look before a plan leaves: no leg may meet a zone. Knows nothing of the graph and shares no code with it."""

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry


class RouteMeetsZone(Exception):
    """A leg of a finished route meets a no-fly zone."""

    def __init__(self, zone: int, start: tuple[float, float], end: tuple[float, float]) -> None:
        super().__init__(f"the leg from {start} to {end} meets zone number {zone}")
        self.zone = zone
        self.start = start
        self.end = end


def legs_that_meet(line: NDArray[np.float64], zones: Sequence[BaseGeometry]) -> list[tuple[int, int]]:
    """Pairs (leg, zone) that have a point in common; line has shape (n, 2), a leg is straight in lon/lat."""
    if len(line) < 2 or not len(zones):
        return []
    west, south, east, north = line[:, 0].min(), line[:, 1].min(), line[:, 0].max(), line[:, 1].max()
    boxes = shapely.bounds(zones)
    near = ~((boxes[:, 0] > east) | (boxes[:, 2] < west) | (boxes[:, 1] > north) | (boxes[:, 3] < south))
    if not near.any():
        return []
    legs = shapely.linestrings(np.stack([line[:-1], line[1:]], axis=1))
    meetings = []
    for number in np.flatnonzero(near).tolist():
        shapely.prepare(zones[number])
        meetings += [(int(leg), number) for leg in np.flatnonzero(shapely.intersects(zones[number], legs))]
    return meetings


def refuse_legs_in_zones(line: NDArray[np.float64], zones: Sequence[BaseGeometry]) -> None:
    """Raises RouteMeetsZone for the first leg on the way that meets a zone."""
    for leg, zone in sorted(legs_that_meet(line, zones)):
        raise RouteMeetsZone(zone, (float(line[leg][0]), float(line[leg][1])), (float(line[leg + 1][0]), float(line[leg + 1][1])))
