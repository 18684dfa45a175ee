"""The flat frame against the ellipsoid."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from inspection.geodesy import distance_m
from inspection.geodesy.local_frame import LocalFrame


@given(st.floats(-179, 179), st.floats(-70, 70), st.floats(0, 2 * np.pi), st.floats(1, 5_000))
def test_lengths_in_the_frame_are_geodesic_within_a_thousandth(lon, lat, angle, length_m):
    frame = LocalFrame.around(lon, lat)
    end = frame.to_degrees(np.array([[np.cos(angle) * length_m, np.sin(angle) * length_m]]))
    assert distance_m(np.array([[lon, lat]]), end)[0] == pytest.approx(length_m, rel=1e-3, abs=1e-3)


def test_the_way_back_from_metres_is_exact():
    frame = LocalFrame.around(9.5, 47.1)
    points = np.array([[9.5, 47.1], [9.51, 47.09], [9.4, 47.2]])
    assert frame.to_degrees(frame.to_metres(points)) == pytest.approx(points, abs=1e-12)
    assert frame.to_metres(points)[0].tolist() == [0.0, 0.0]
