"""Inside and outside of what a vehicle is given as a fence, against shapely."""

import random

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink
from shapely import Point, Polygon

from inspection.geodesy import LonLat
from mavlink.vehicle_plan import MissionItem
from simulation.vehicle_protocol.fence import fence_of

INSIDE, OUTSIDE = mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION, mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION


def area(command, corners):
    return [MissionItem(command, 0, (float(len(corners)), 0.0, 0.0, 0.0), round(lon * 1e7), round(lat * 1e7)) for lon, lat in corners]


def circle(command, lon, lat, radius_m):
    return [MissionItem(command, 0, (radius_m, 0.0, 0.0, 0.0), round(lon * 1e7), round(lat * 1e7))]


@pytest.mark.parametrize("seed", range(10))
def test_a_polygon_covers_what_it_covers(seed):
    """Also one that is not convex, given either way round."""
    chance = random.Random(seed)
    corners = [(10 + chance.uniform(0, 0.01), 55 + chance.uniform(0, 0.01)) for _ in range(5)]
    drawn = Polygon(corners)
    if not drawn.is_valid:
        drawn = Polygon(drawn.convex_hull.exterior.coords[:-1])
        corners = list(drawn.exterior.coords[:-1])
    kept, barred = fence_of(area(INSIDE, corners)), fence_of(area(OUTSIDE, corners))
    for _ in range(200):
        place = LonLat(10 + chance.uniform(-0.002, 0.012), 55 + chance.uniform(-0.002, 0.012))
        if drawn.exterior.distance(Point(place)) < 1e-6:
            continue
        assert kept.is_broken_at(place) != drawn.covers(Point(place)) != (not barred.is_broken_at(place))


def test_all_areas_count_and_none_is_no_fence():
    fence = fence_of([
        *area(INSIDE, [(10.0, 55.0), (10.1, 55.0), (10.1, 55.1), (10.0, 55.1)]),
        *circle(mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION, 10.05, 55.05, 500.0),
        *circle(mavlink.MAV_CMD_NAV_FENCE_RETURN_POINT, 10.05, 55.05, 0.0),
    ])  # fmt: skip
    assert not fence.is_broken_at(LonLat(10.02, 55.02))
    assert fence.is_broken_at(LonLat(10.05, 55.05)) and fence.is_broken_at(LonLat(10.05, 55.0505))
    assert fence.is_broken_at(LonLat(10.2, 55.05))
    assert not fence_of([]).is_broken_at(LonLat(0.0, 0.0))


def test_a_circle_reaches_as_far_east_as_north():
    fence = fence_of(circle(mavlink.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION, 10.0, 60.0, 111.195))
    north_deg, east_deg = 0.001, 0.002
    for share, is_out in ((0.98, False), (1.02, True)):
        assert fence.is_broken_at(LonLat(10.0, 60.0 + share * north_deg)) is is_out
        assert fence.is_broken_at(LonLat(10.0 + share * east_deg, 60.0)) is is_out
