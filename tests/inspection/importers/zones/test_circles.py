"""A circle's polygon holds the whole circle and little more."""

import numpy as np
import pytest
import shapely

from inspection.geodesy import LonLat
from inspection.geodesy.geometry_validator import GeometryFault
from inspection.geodesy.wgs84 import WGS84
from inspection.importers.zones.records import checked_radius_m, enclosing_polygon


@pytest.mark.parametrize(
    ("lon", "lat", "radius_m"),
    [
        (6.9, 46.4, 3_000.0),
        (0.0, 0.0, 10.0),
        (10.0, 70.0, 100_000.0),
        (179.99, -17.0, 5_000.0),
        (-180.0, 60.0, 50_000.0),
        (25.0, 85.0, 20_000.0),
    ],
)
def test_every_point_of_the_circle_lies_in_its_polygon(lon, lat, radius_m):
    area = enclosing_polygon(LonLat(lon, lat), radius_m, "place")
    number = 5_003
    circle = WGS84.fwd(np.full(number, lon), np.full(number, lat), np.linspace(0, 360, number), np.full(number, radius_m))
    assert area.is_valid
    assert shapely.intersects_xy(area, circle[0], circle[1]).all()


def test_the_polygon_is_at_most_a_little_larger_than_its_circle():
    area = enclosing_polygon(LonLat(6.9, 46.4), 3_000.0, "place")
    (ring,) = [np.array(part.exterior.coords) for part in area.geoms]
    distances = WGS84.inv(np.full(len(ring), 6.9), np.full(len(ring), 46.4), ring[:, 0], ring[:, 1])[2]
    assert len(ring) == 65
    assert distances.min() > 3_000.0
    assert distances.max() < 3_000.0 * 1.0013  # 1 / cos(π / 64) = 1.0012


@pytest.mark.parametrize("radius", [0, -1, "3", None, True, float("nan"), 1e7, [3]])
def test_a_radius_that_is_none_is_refused(radius):
    with pytest.raises(GeometryFault, match="radius"):
        checked_radius_m(radius, "place")


def test_a_circle_over_a_pole_is_refused():
    with pytest.raises(GeometryFault, match="pole"):
        enclosing_polygon(LonLat(0.0, 89.9), 50_000.0, "place")
