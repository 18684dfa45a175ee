"""Limits as heights above ground: what can be compared, and what reaches everywhere."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from inspection.zones.reach import HeightLimits, ZoneTable, agl_band
from inspection.zones.schedule import ZoneRules

INF = math.inf


@pytest.mark.parametrize(
    ("limits", "band"),
    [  # over ground between 100 m and 250 m above the sea
        (HeightLimits(30.0, "AGL", 120.0, "AGL"), (30.0, 120.0)),
        (HeightLimits(400.0, "AMSL", 1_000.0, "AMSL"), (150.0, 900.0)),
        (HeightLimits(0.0, "AGL", 1_000.0, "AMSL"), (0.0, 900.0)),
        (HeightLimits(None, "", 120.0, "AGL"), (-INF, 120.0)),
        (HeightLimits(30.0, "AGL", None, ""), (30.0, INF)),
        (HeightLimits(None, "", None, ""), (-INF, INF)),
        (HeightLimits(3_000.0, "STD", 5_000.0, "STD"), (-INF, INF)),
        (HeightLimits(3_000.0, "WGS84", 5_000.0, "WGS84"), (-INF, INF)),
        (HeightLimits(3_000.0, "", 5_000.0, ""), (-INF, INF)),
        (HeightLimits(math.nan, "AGL", 120.0, "AGL"), (-INF, 120.0)),
        (HeightLimits(500.0, "AGL", 300.0, "AMSL"), (-INF, INF)),  # upside down
    ],
)
def test_limits_over_hills(limits: HeightLimits, band: tuple[float, float]) -> None:
    assert agl_band(limits, 100.0, 250.0) == band


def test_over_ground_that_is_not_known_limits_above_sea_level_reach_everywhere() -> None:
    assert agl_band(HeightLimits(400.0, "AMSL", 1_000.0, "AMSL")) == (-INF, INF)
    assert agl_band(HeightLimits(30.0, "AGL", 1_000.0, "AMSL")) == (30.0, INF)


heights = st.floats(-400, 4_000)


@given(lower=heights, thick=st.floats(0, 2_000), ground=st.tuples(heights, heights), share=st.floats(0, 1), above=st.floats(0, 1))
def test_no_place_of_a_zone_lies_outside_its_band(
    lower: float, thick: float, ground: tuple[float, float], share: float, above: float
) -> None:
    lowest, highest = sorted(ground)
    floor_m, ceiling_m = agl_band(HeightLimits(lower, "AMSL", lower + thick, "AMSL"), lowest, highest)
    here_m = lowest + share * (highest - lowest)
    assert floor_m - 1e-6 <= lower + above * thick - here_m <= ceiling_m + 1e-6


def table(*rows: tuple[HeightLimits, object]) -> ZoneTable:
    boxes = [shapely.MultiPolygon([shapely.box(number, 0, number + 0.5, 0.5)]) for number in range(len(rows))]
    bands = [agl_band(limits) for limits, _ in rows]
    return ZoneTable(
        ids=np.arange(10, 10 + len(rows)),
        names=tuple(f"Zone {number}" for number in range(len(rows))),
        wkb=tuple(shapely.to_wkb(box) for box in boxes),
        box=shapely.bounds(boxes),
        floor_agl_m=np.array([floor for floor, _ in bands]),
        ceiling_agl_m=np.array([ceiling for _, ceiling in bands]),
        limits=tuple(limits for limits, _ in rows),
        schedules=tuple(schedule for _, schedule in rows),  # type: ignore[misc]
        rules=ZoneRules(time_margin_s=300, height_margin_m=10),
    )


EVERYWHERE = HeightLimits(None, "", None, "")
HOURS_8_TO_18 = [
    {
        "startDateTime": None, "endDateTime": None,
        "schedule": [{"day": ["ANY"], "startTime": "08:00:00Z", "startEvent": None, "endTime": "18:00:00Z", "endEvent": None}],
    }
]  # fmt: skip


def test_a_height_margin_is_kept_below_and_above() -> None:
    zones = table((HeightLimits(80.0, "AGL", 120.0, "AGL"), None), (EVERYWHERE, None))
    assert zones.reaching(0.0, 69.0).tolist() == [False, True]
    assert zones.reaching(0.0, 70.0).tolist() == [True, True]
    assert zones.reaching(130.0, 140.0).tolist() == [True, True]
    assert zones.reaching(131.0, 140.0).tolist() == [False, True]


def test_which_zones_apply_in_a_window_and_through_it() -> None:
    """Day 0 of the epoch; margins of 5 min make the hours 07:55 to 18:05."""
    zones = table((EVERYWHERE, HOURS_8_TO_18), (EVERYWHERE, None))
    hour = 3_600.0
    assert zones.active_within(6 * hour, 7.9 * hour).tolist() == [False, True]
    assert zones.active_within(6 * hour, 7.95 * hour).tolist() == [True, True]
    assert zones.active_throughout(9 * hour, 18.05 * hour).tolist() == [True, True]
    assert zones.active_throughout(9 * hour, 18.15 * hour).tolist() == [False, True]
    assert zones.spans(17 * hour, 20 * hour)[0] == ((17 * hour, 18 * hour + 300),)


def test_a_part_of_a_table_has_its_rows() -> None:
    zones = table((EVERYWHERE, HOURS_8_TO_18), (HeightLimits(30.0, "AGL", None, ""), None), (EVERYWHERE, None))
    part = zones.only(np.array([False, True, True]))
    assert part.ids.tolist() == [11, 12]
    assert part.names == ("Zone 1", "Zone 2")
    assert part.floor_agl_m.tolist() == [30.0, -INF]
    assert [polygon.bounds[0] for polygon in part.polygons] == [1.0, 2.0]
    assert part.schedules == (None, None)
