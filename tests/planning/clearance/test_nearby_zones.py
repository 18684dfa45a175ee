"""Of a table of zones those near a route, with what they state."""

import math

import numpy as np
import shapely

from inspection.zones.reach import HeightLimits, ZoneTable
from inspection.zones.schedule import ZoneRules
from planning.clearance.nearby_zones import zones_near
from planning.clearance.zone_clearance import FlownRoute, Margins, breaches

DAILY = [
    {
        "startDateTime": None, "endDateTime": None,
        "schedule": [{"day": ["ANY"], "startTime": "08:00:00Z", "startEvent": None, "endTime": "10:00:00Z", "endEvent": None}],
    }
]  # fmt: skip
HOUR_S = 3_600.0
ALONG = np.array([[10.0, 60.0], [10.02, 60.0]])


def table(*boxes: tuple[float, float, float, float]) -> ZoneTable:
    """The zones apply from 8 to 10 o'clock and reach from 100 m up."""
    shapes = [shapely.box(*box) for box in boxes]
    return ZoneTable(
        ids=np.arange(len(boxes)) + 7,
        names=tuple(f"Zone {number}" for number in range(len(boxes))),
        wkb=tuple(shapely.to_wkb(shape) for shape in shapes),
        box=shapely.bounds(shapes).reshape(-1, 4),
        floor_agl_m=np.full(len(boxes), 100.0),
        ceiling_agl_m=np.full(len(boxes), math.inf),
        limits=(HeightLimits(100.0, "AGL", None, ""),) * len(boxes),
        schedules=(DAILY,) * len(boxes),
        rules=ZoneRules(time_margin_s=300.0),
    )


def test_only_zones_whose_box_comes_near_are_looked_at() -> None:
    """At 60 N a degree of longitude has 55,800 m: 0.001 degrees are 56 m."""
    zones = table((9.9, 59.9, 9.999, 60.1), (10.01, 59.9, 10.011, 60.1), (11.0, 59.9, 11.1, 60.1))
    assert zones_near(zones, ALONG, Margins())[0].ids.tolist() == [8]
    assert zones_near(zones, ALONG, Margins(lateral_m=50.0))[0].ids.tolist() == [8]
    assert zones_near(zones, ALONG, Margins(lateral_m=60.0))[0].ids.tolist() == [7, 8]
    assert len(zones_near(zones, np.zeros((0, 2)), Margins())[0]) == 0


def test_spans_reach_as_far_as_the_margin_and_are_not_widened_twice() -> None:
    zones = table((10.01, 59.9, 10.011, 60.1))
    _, facts = zones_near(zones, ALONG, Margins(time_s=300.0), (10 * HOUR_S + 200.0, 11 * HOUR_S))
    assert facts.spans == (((10 * HOUR_S - 100.0, 10 * HOUR_S),),)
    _, anytime = zones_near(zones, ALONG, Margins(time_s=300.0))
    assert anytime.spans == (None,)


def test_a_flight_just_after_a_zone_has_ended_is_within_its_margin() -> None:
    zones, margins = table((10.01, 59.9, 10.011, 60.1)), Margins(time_s=300.0)

    def met(departs_s: float, agl_m: float = 110.0) -> bool:
        route = FlownRoute(ALONG, np.full(2, agl_m), None, departs_s + np.array([10.0, 100.0]), departs_s, departs_s + 120.0)
        return bool(breaches(route, zones_near(zones, ALONG, margins, (departs_s, departs_s + 120.0))[1], margins))

    assert met(10 * HOUR_S + 289.0)
    assert not met(10 * HOUR_S + 290.0)
    assert not met(10 * HOUR_S + 289.0, agl_m=90.0)
    assert met(8 * HOUR_S - 400.0)
    assert not met(8 * HOUR_S - 401.0)


def test_times_that_run_backwards_bar_what_lies_between() -> None:
    zones = table((10.01, 59.9, 10.011, 60.1))
    route = FlownRoute(ALONG, np.full(2, 110.0), None, np.array([11 * HOUR_S, 7 * HOUR_S]), 7 * HOUR_S, 11 * HOUR_S)
    assert breaches(route, zones_near(zones, ALONG, Margins(), (7 * HOUR_S, 11 * HOUR_S))[1], Margins())
