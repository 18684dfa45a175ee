"""Estimates are compared with what was measured of the same moments, by hand-worked distances."""

import math

import pytest

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from telemetry.estimation.estimate import Ellipse
from telemetry.mission_report.estimate_quality import Estimated, MeasuredError, compare, estimate_quality, quality_of

FRAME = LocalFrame.around(10.0, 56.0)


def place(east_m: float, north_m: float) -> LonLat:
    return LonLat(10.0 + east_m / FRAME.metres_per_degree_east, 56.0 + north_m / FRAME.metres_per_degree_north)


def estimated(at_s: float, east_m: float, north_m: float, *, bound: Ellipse | None = None, report_s: float = 0.0) -> Estimated:
    return Estimated(at_s, place(east_m, north_m), bound or Ellipse(10.0, 5.0, 90.0), report_s, 60.0, 4.0)


def test_an_error_is_the_distance_to_the_place_between_two_measurements():
    measured = [MeasuredError(10.0, place(0, 0), 60.0), MeasuredError(12.0, place(20, 0), 70.0)]
    found = estimate_quality([estimated(11.0, 13, 4)], measured).whole
    assert found.count == 1
    assert found.rms_m == pytest.approx(5.0, abs=0.01)
    assert found.height_rms_m == pytest.approx(5.0)
    assert found.height_inside_share == 0.0


def test_the_bound_is_an_ellipse_along_its_bearing():
    measured = [MeasuredError(10.0, place(0, 0)), MeasuredError(12.0, place(0, 0))]
    quality = estimate_quality([estimated(11.0, 9, 0), estimated(11.0, 0, 9), estimated(11.0, 8, 4)], measured)
    assert quality.whole.inside_share == pytest.approx(1 / 3)
    turned = [estimated(11.0, 9, 0, bound=Ellipse(10.0, 5.0, 0.0)), estimated(11.0, 0, 9, bound=Ellipse(10.0, 5.0, 0.0))]
    assert [one.is_inside for one in compare(turned, measured)[0]] == [False, True]


def test_one_measurement_tells_of_its_own_second_by_its_speed():
    measured = [MeasuredError(10.0, place(0, 0), None, 10.0, 0.0), MeasuredError(60.0, place(0, 0))]
    quality = estimate_quality([estimated(10.4, 4, 3), estimated(30.0, 0, 0)], measured)
    assert quality.whole.rms_m == pytest.approx(3.0, abs=0.01)
    assert quality.untold == 1


def test_estimates_are_told_apart_by_the_age_of_the_last_report():
    measured = [MeasuredError(float(second), place(0, 0)) for second in range(60)]
    compared, untold = compare([estimated(1.0, 1, 0), estimated(8.0, 2, 0), estimated(9.0, 4, 0), estimated(50.0, 100, 0)], measured)
    quality = quality_of(compared, untold)
    assert [(group.up_to_s, group.count) for group in quality.by_age] == [(2.0, 1), (5.0, 0), (10.0, 2), (30.0, 0), (math.inf, 1)]
    assert quality.by_age[2].rms_m == pytest.approx(math.sqrt(10.0), abs=0.01)
    assert quality.by_age[1].rms_m is None
    assert quality.whole.largest_m == pytest.approx(100.0, abs=0.1)
