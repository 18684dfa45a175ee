"""An approved flight as a line: a UAV's progress along it, its offset, and the planned height there."""

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import accumulate, pairwise

import numpy as np

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import HOVER, Flight, photo_clearances_m

NEAR_VERTEX_M = 15.0  # an autopilot accepts a waypoint before it is reached, and climbs or descends near it
LEGS_BACK, LEGS_ON = 2, 1  # search range around the leg to the reported waypoint, which may be some seconds old
LEG_OFF_M = 15.0  # penalty for each leg of difference from the expected leg
NEAR_HEIGHT_M = 2.0  # further below the first waypoint it is still climbing to it
SINK_MPS = 1.0  # when landing
BACK_M, ON_M = 60.0, 600.0  # search range around the previous place if no waypoint is reported

Point = tuple[float, float, float]  # east, north, height above take-off [m]


@dataclass(frozen=True, slots=True)
class RoutePlace:
    """The nearest point of the line. `leg` leads from vertex `leg` to the next; `share` of it lies behind."""

    along_m: float
    across_m: float
    leg: int
    share: float


class RouteLine:
    """A flight from its first waypoint to its last, in a flat frame: lengths are within 1 % over some 20 km.

    vertices (east, north) [m], along_m, heights_m above this flight's take-off, hold_s and sequences have one entry for each waypoint.
    clearances_m: what the flight keeps from wires and supports [m], by its legs through photos.
    """

    def __init__(self, flight: Flight, charging: tuple[int, ...] = ()) -> None:
        """charging: sequences of the route's waypoints with a planned charging stop."""
        waypoints = flight.waypoints
        middle = waypoints[len(waypoints) // 2].position
        self.frame = LocalFrame.around(middle.lon, middle.lat)
        metres = self.frame.to_metres(np.array([waypoint.position for waypoint in waypoints], dtype=np.float64))
        self.vertices: list[tuple[float, float]] = [(float(east), float(north)) for east, north in metres]
        self.along_m = list(accumulate((math.dist(*leg) for leg in pairwise(self.vertices)), initial=0.0))
        self.heights_m = [waypoint.altitude_relative_m for waypoint in waypoints]
        self.grounds_m = [waypoint.ground_relative_m for waypoint in waypoints]
        self.hold_s = [0.0 if waypoint.task is None else waypoint.task.hold_s for waypoint in waypoints]
        self.sequences = [waypoint.sequence for waypoint in waypoints]
        beside_wires = photo_clearances_m(waypoints)
        self.clearances_m = {place - 1: beside_wires[own] for place, own in enumerate(self.sequences) if own in beside_wires}
        self.charges_at = {place for place, sequence in enumerate(self.sequences) if sequence in charging}
        self.lands = flight.end_action != HOVER
        self.arrival_s = [waypoint.arrival_s for waypoint in waypoints]

    @property
    def length_m(self) -> float:
        return self.along_m[-1]

    def east_north(self, position: LonLat) -> tuple[float, float]:
        origin = self.frame.origin
        return (
            (position.lon - origin.lon) * self.frame.metres_per_degree_east,
            (position.lat - origin.lat) * self.frame.metres_per_degree_north,
        )

    def vertex_of(self, sequence: int | None) -> int | None:
        """Return the vertex of a waypoint of the route; None if it belongs to another flight or is unknown."""
        if sequence is None or not self.sequences[0] <= sequence <= self.sequences[-1]:
            return None
        return bisect_right(self.sequences, sequence) - 1

    def place(self, position: LonLat, sequence: int | None = None, before: RoutePlace | None = None) -> RoutePlace:
        """Return the nearest point of the likely legs: those near the waypoint that it flies to, else near its previous place.

        A path out and back covers the same ground twice: the expected leg is used unless another is clearly nearer.
        """
        east, north = self.east_north(position)
        vertex = self.vertex_of(sequence)
        first, last = 0, max(len(self.vertices) - 2, 0)
        if vertex is not None:
            first, last = max(vertex - 1 - LEGS_BACK, 0), min(max(vertex - 1 + LEGS_ON, 0), last)
        elif before is not None:
            first = max(bisect_right(self.along_m, before.along_m - BACK_M) - 1, 0)
            last = min(max(bisect_right(self.along_m, before.along_m + ON_M) - 1, first), last)
        expected = before.leg if vertex is None and before is not None else None if vertex is None else max(vertex - 1, 0)
        found = [self._beside(leg, east, north) for leg in range(first, last + 1)]
        nearest = min(found, key=lambda place: place.across_m + (0.0 if expected is None else LEG_OFF_M * abs(place.leg - expected)))
        return replace(nearest, across_m=min(place.across_m for place in found))

    def place_from(self, position: LonLat, before: RoutePlace) -> RoutePlace:
        """Return the nearest point of all legs from its previous place on; the first of equals."""
        east, north = self.east_north(position)
        last = max(len(self.vertices) - 2, 0)
        return min((self._beside(leg, east, north) for leg in range(min(before.leg, last), last + 1)), key=lambda place: place.across_m)

    def beside(self, leg: int, position: LonLat) -> RoutePlace:
        """Return the nearest point of one leg."""
        return self._beside(leg, *self.east_north(position))

    def _beside(self, leg: int, east: float, north: float) -> RoutePlace:
        (east_1, north_1), (east_2, north_2) = self.vertices[leg], self.vertices[min(leg + 1, len(self.vertices) - 1)]
        de, dn = east_2 - east_1, north_2 - north_1
        square = de * de + dn * dn
        share = 0.0 if square == 0.0 else min(1.0, max(0.0, ((east - east_1) * de + (north - north_1) * dn) / square))
        across_m = math.hypot(east - east_1 - share * de, north - north_1 - share * dn)
        return RoutePlace(self.along_m[leg] + share * math.sqrt(square), across_m, leg, share)

    def heights_at(self, place: RoutePlace) -> tuple[float, float]:
        """Return the lowest and highest planned height at a place [m above take-off].

        An autopilot climbs evenly along a leg, while the plan's times assume the climb first; every height in between is accepted. Near a
        waypoint the heights of both legs are accepted, and below the first and last waypoint all down to the ground.
        """
        last = len(self.vertices) - 1
        end = min(place.leg + 1, last)
        start_m, end_m = self.heights_m[place.leg], self.heights_m[end]
        heights_m = [start_m, start_m + place.share * (end_m - start_m)]
        for vertex in (place.leg, end):
            if abs(self.along_m[vertex] - place.along_m) <= NEAR_VERTEX_M:
                heights_m += self.heights_m[max(vertex - 1, 0) : min(vertex + 1, last) + 1]
                if vertex == 0:
                    heights_m.append(min(0.0, self.grounds_m[0]))
                if vertex == last and self.lands:
                    heights_m.append(self.grounds_m[last])
                if vertex in self.charges_at:
                    heights_m.append(self.grounds_m[vertex])
        return min(heights_m), max(heights_m)

    def away_m(self, place: RoutePlace, position: LonLat, height_m: float) -> float:
        """Return the distance in space from the leg of a place or a neighbour of it [m]. height_m: above this flight's take-off."""
        here = np.array([*self.east_north(position), height_m])
        last = max(len(self.vertices) - 2, 0)
        found = []
        for leg in range(max(place.leg - 1, 0), min(place.leg + 1, last) + 1):
            start, end = (np.array([*self.vertices[own], self.heights_m[own]]) for own in (leg, min(leg + 1, len(self.vertices) - 1)))
            along = end - start
            square = float(along @ along)
            share = 0.0 if square == 0.0 else min(max(float((here - start) @ along) / square, 0.0), 1.0)
            found.append(float(np.linalg.norm(start + share * along - here)))
        return min(found)

    def ground_m(self, place: RoutePlace) -> float:
        """Return the planned ground height at a place, above this flight's take-off."""
        end = min(place.leg + 1, len(self.vertices) - 1)
        return self.grounds_m[place.leg] + place.share * (self.grounds_m[end] - self.grounds_m[place.leg])

    def at(self, along_m: float) -> tuple[float, float]:
        """Return east and north [m] at a length along the line, clamped to its ends."""
        leg = min(max(bisect_right(self.along_m, along_m) - 1, 0), max(len(self.vertices) - 2, 0))
        (east_1, north_1), (east_2, north_2) = self.vertices[leg], self.vertices[min(leg + 1, len(self.vertices) - 1)]
        length_m = self.along_m[min(leg + 1, len(self.vertices) - 1)] - self.along_m[leg]
        share = 0.0 if length_m <= 0.0 else min(1.0, max(0.0, (along_m - self.along_m[leg]) / length_m))
        return east_1 + share * (east_2 - east_1), north_1 + share * (north_2 - north_1)

    def planned_ahead(self, place: RoutePlace, height_m: float, climb_mps: float, seconds: Sequence[float]) -> list[Point] | None:
        """Return the planned positions after so many seconds from a place and a height [m above take-off]; None without planned times.

        From the ground it first climbs vertically to its first waypoint. At a waypoint it continues at once; at the end it descends. Also
        None at the end of the line or at a charging stop, where the duration of the stay is not planned.
        """
        moments, points = self._timetable
        if not moments or self.length_m - place.along_m <= NEAR_VERTEX_M < self.length_m or self._charges_near(place):
            return None
        start_s, climbs_s = self._planned_s(place), 0.0
        if place.along_m <= NEAR_VERTEX_M and height_m < self.heights_m[0] - NEAR_HEIGHT_M:
            climbs_s = (self.heights_m[0] - height_m) / climb_mps
        found = []
        for after_s in seconds:
            if after_s < climbs_s:
                found.append((*self.vertices[0], height_m + climb_mps * after_s))
            else:
                moment_s = start_s + after_s - climbs_s
                east, north, up = (float(np.interp(moment_s, moments, column)) for column in points)
                sinks_m = max(moment_s - moments[-1], 0.0) * SINK_MPS if self.lands else 0.0
                found.append((east, north, max(up - sinks_m, min(up, self.grounds_m[-1]))))
        return found

    @cached_property
    def _timetable(self) -> tuple[list[float], tuple[list[float], list[float], list[float]]]:
        """Return the times of arrival and departure at each waypoint, and its position (east, north, height); empty if unknown."""
        arrival_s = [moment for moment in self.arrival_s if moment is not None]
        if len(arrival_s) < len(self.vertices):
            return [], ([], [], [])
        moments: list[float] = []
        for vertex, arrives_s in enumerate(arrival_s):
            moments += [arrives_s, arrives_s + self.hold_s[vertex]]
        twice = [vertex for vertex in range(len(self.vertices)) for _ in range(2)]
        points = (
            [self.vertices[vertex][0] for vertex in twice], [self.vertices[vertex][1] for vertex in twice],
            [self.heights_m[vertex] for vertex in twice],
        )  # fmt: skip
        return list(accumulate(moments, max)), points

    def _charges_near(self, place: RoutePlace) -> bool:
        return any(abs(self.along_m[vertex] - place.along_m) <= NEAR_VERTEX_M for vertex in self.charges_at)

    def _planned_s(self, place: RoutePlace) -> float:
        moments, _ = self._timetable
        end = min(place.leg + 1, len(self.vertices) - 1)
        leaves_s, arrives_s = moments[2 * place.leg + 1], moments[2 * end]
        if self.along_m[end] - place.along_m <= NEAR_VERTEX_M and place.share > 0.5:
            return moments[2 * end + 1]
        return leaves_s + place.share * max(arrives_s - leaves_s, 0.0)

    def agl_between(self, from_m: float, to_m: float) -> list[float]:
        """Return the heights above ground of the waypoints between two lengths along the line."""
        first, last = bisect_right(self.along_m, from_m), bisect_right(self.along_m, to_m)
        return [self.heights_m[vertex] - self.grounds_m[vertex] for vertex in range(first, last)]

    def planned_hold_s(self, along_m: float) -> float:
        """Return the planned hold at waypoints near a length along the line; infinite at a charging stop."""
        holds_s = 0.0
        for vertex, at_m in enumerate(self.along_m):
            if abs(at_m - along_m) <= 2.0 * NEAR_VERTEX_M:
                holds_s = math.inf if vertex in self.charges_at else holds_s + self.hold_s[vertex]
        return holds_s
