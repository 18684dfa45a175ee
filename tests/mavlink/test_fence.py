"""No-fly zones as a vehicle's own fence."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink
from shapely import LineString, Point, Polygon

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import FrozenRoute
from mavlink.fence import Fence, FenceRules, FenceZone, fence_of, rally_items
from mavlink.mission_items import CannotBeFlown, flight_loads
from mavlink.vehicle_plan import MissionItem
from planning.trajectory.waypoints import WaypointKind
from tests.mavlink.routes import START, route, start_and_end, waypoint

FRAME = LocalFrame.around(*START)
ROUTE = start_and_end(waypoint(1, WaypointKind.PASS, lon=START.lon + 0.01))


def zone(name: str, *east_north_m: tuple[float, float]) -> FenceZone:
    return FenceZone(name, tuple(LonLat(*place) for place in FRAME.to_degrees(np.array(east_north_m)).tolist()))


def square(name: str, east_m: float, north_m: float, size_m: float = 50.0) -> FenceZone:
    return zone(name, (east_m, north_m), (east_m + size_m, north_m), (east_m + size_m, north_m + size_m), (east_m, north_m + size_m))


def ring(name: str, vertices: int, *, north_m: float = 400.0, radii_m: tuple[float, ...] = (100.0,)) -> FenceZone:
    angles = [2 * math.pi * number / vertices for number in range(vertices)]
    radius_m = [radii_m[number % len(radii_m)] for number in range(vertices)]
    return zone(name, *((r * math.cos(angle), north_m + r * math.sin(angle)) for r, angle in zip(radius_m, angles, strict=True)))


def polygons(items: tuple[MissionItem, ...]) -> list[Polygon]:
    """As an autopilot takes them apart, by the number of vertices."""
    found, begin = [], 0
    while begin < len(items):
        count = int(items[begin].parameters[0])
        part = items[begin : begin + count]
        assert {(item.command, item.parameters[0]) for item in part} == {(mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION, count)}
        found.append(Polygon(FRAME.to_metres(np.array([(item.longitude_e7 / 1e7, item.latitude_e7 / 1e7) for item in part]))))
        begin += count
    return found


def area(of: FenceZone) -> Polygon:
    return Polygon(FRAME.to_metres(np.array(of.outline)))


def codes(fence: Fence) -> list[tuple[str, str]]:
    return [(left.zone, left.code) for left in fence.left_out]


def test_zone_beside_the_route_is_sent_as_it_is():
    beside = square("harbour", 100, 100)
    fence = fence_of([beside], ROUTE)
    assert fence.left_out == ()
    assert [(item.longitude_e7, item.latitude_e7) for item in fence.items] == [
        (round(place.lon * 1e7), round(place.lat * 1e7)) for place in beside.outline
    ]
    assert {item.frame for item in fence.items} == {mavlink.MAV_FRAME_GLOBAL}


@pytest.mark.parametrize("north_m", [-25.0, 4.0])
def test_zone_that_the_route_passes_over_or_close_to_is_left_out_and_told(north_m: float):
    fence = fence_of([square("forest", 100, north_m)], ROUTE)
    assert (fence.items, codes(fence)) == ((), [("forest", "crosses-route")])


def test_zone_far_away_is_not_sent_and_needs_no_word():
    assert fence_of([square("far", 0, 9_000)], ROUTE) == Fence((), ())


def test_zone_that_crosses_itself_is_left_out_and_told():
    bowtie = zone("bowtie", (0, 100), (50, 150), (50, 100), (0, 150))
    assert codes(fence_of([bowtie, FenceZone("line", bowtie.outline[:2])], ROUTE)) == [("bowtie", "not-simple"), ("line", "not-simple")]


@given(vertices=st.integers(71, 300), radii_m=st.lists(st.floats(60, 120), min_size=1, max_size=9))
def test_zone_of_many_vertices_is_drawn_larger_and_never_smaller(vertices: int, radii_m: list[float]):
    rough = ring("rough", vertices, radii_m=tuple(radii_m))
    fence = fence_of([rough], ROUTE)
    if fence.left_out:
        assert codes(fence) == [("rough", "too-detailed")]
        return
    (drawn,) = polygons(fence.items)
    assert len(fence.items) <= 64
    assert drawn.is_valid and drawn.covers(area(rough))
    assert max(area(rough).distance(Point(vertex)) for vertex in drawn.exterior.coords) <= 3 * FenceRules().most_growth_m


def test_zone_that_would_reach_the_route_when_drawn_larger_is_left_out_and_told():
    spiky = ring("spiky", 200, north_m=109.0, radii_m=(100.0, 60.0))
    assert codes(fence_of([spiky], ROUTE)) == [("spiky", "too-detailed")]


def test_fence_never_touches_the_route():
    zones = [ring(f"ring {number}", 90, north_m=150.0 + 260 * number, radii_m=(100.0, 93.0)) for number in range(3)]
    fence = fence_of(zones, ROUTE)
    line = LineString(FRAME.to_metres(np.array([start.position for start in ROUTE.waypoints])))
    assert fence.items
    assert all(drawn.distance(line) >= FenceRules().keeps_clear_m for drawn in polygons(fence.items))


def test_full_fence_keeps_the_nearest_zones_and_tells_of_the_others():
    zones = [square(f"square {number}", 0, 100.0 + 60 * number) for number in range(20)]
    fence = fence_of(list(reversed(zones)), ROUTE)
    assert len(fence.items) == 64
    assert codes(fence) == [(f"square {number}", "no-space") for number in range(16, 20)]


def test_fence_has_no_more_items_than_the_vehicle_takes():
    zones = [ring(f"ring {number}", 90, north_m=150.0 + 260 * number, radii_m=(100.0, 93.0)) for number in range(6)]
    fence = fence_of(zones, ROUTE)
    assert len(fence.items) <= FenceRules().most_items
    assert len(polygons(fence.items)) + len(fence.left_out) == 6


def test_route_without_waypoints_has_no_fence():
    assert fence_of([square("harbour", 100, 100)], route([])) == Fence((), ())


def test_rally_points_are_whole_metres_up():
    (item,) = rally_items([(START, 40.2)])
    assert (item.command, item.longitude_e7, item.latitude_e7, item.altitude_m) == (5100, 98000000, 554000000, 41.0)


def two_bases(second_ground_m: float) -> FrozenRoute:
    """Its second flight takes off from a base that is so much higher than the first."""
    base = waypoint(2, WaypointKind.BASE, relative_m=second_ground_m, agl_m=0.0)
    end = waypoint(4, WaypointKind.END, relative_m=second_ground_m + 60.0)
    return route([waypoint(0, WaypointKind.START), waypoint(1, WaypointKind.PASS), base,
                  waypoint(3, WaypointKind.PASS, relative_m=second_ground_m + 60.0), end])  # fmt: skip


@pytest.mark.parametrize("second_ground_m", [60.0, -60.0, 0.4])
def test_rally_points_lie_as_high_above_the_sea_on_each_flight(second_ground_m: float):
    first, second = flight_loads(two_bases(second_ground_m), rally=rally_items([(START, 80.0)]))
    assert first.rally[0].altitude_m == 80.0
    assert 0.0 <= second.rally[0].altitude_m + second_ground_m - 80.0 < 1.0


def test_a_rally_point_below_a_take_off_is_refused():
    with pytest.raises(CannotBeFlown) as refusal:
        flight_loads(two_bases(60.0), rally=rally_items([(START, 50.0)]))
    assert refusal.value.code == "rally-height"
