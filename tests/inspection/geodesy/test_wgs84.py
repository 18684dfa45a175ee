"""Distances on the ellipsoid, against GeographicLib's as pyproj has them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from inspection.geodesy.wgs84 import WGS84, distance_m, path_length_m

LON, LAT, STEP = st.floats(-180, 180), st.floats(-90, 90), st.floats(-1, 1)


@given(LON, LAT, STEP, STEP)
def test_short_distances_are_right_to_a_micrometre(lon: float, lat: float, east: float, north: float) -> None:
    end = lon + east, min(90.0, max(-90.0, lat + north))
    assert distance_m(np.array([lon, lat]), np.array(end))[0] == pytest.approx(WGS84.inv(lon, lat, *end)[2], abs=1e-6)


@given(LON, LAT, LON, LAT)
def test_any_distance_is_right_to_a_micrometre(lon: float, lat: float, other_lon: float, other_lat: float) -> None:
    metres = distance_m(np.array([lon, lat]), np.array([other_lon, other_lat]))[0]
    assert metres == pytest.approx(WGS84.inv(lon, lat, other_lon, other_lat)[2], abs=1e-6)


def test_mapped_and_broadcast_positions_are_read_as_they_are() -> None:
    positions = np.array([[9.0, 47.0], [9.001, 47.0], [9.001, 47.001]])
    positions.setflags(write=False)
    here = np.broadcast_to(positions[0], (3, 2))
    assert distance_m(here, positions)[0] == 0.0
    assert distance_m(here, positions[::-1])[2] == 0.0
    assert path_length_m(positions) == pytest.approx(distance_m(positions[:-1], positions[1:]).sum())


def test_across_the_date_line_it_is_the_short_way() -> None:
    assert distance_m(np.array([179.9995, 60.0]), np.array([-179.9995, 60.0]))[0] == pytest.approx(55.8, abs=0.1)
