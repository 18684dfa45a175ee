"""A law: whatever zones lie on a small world and whatever is asked, no leg of a plan meets a zone."""

from itertools import pairwise
from typing import Any

import pytest
from django.contrib.gis.geos import MultiPolygon, Polygon
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from inspection.models import Asset, NoFlyZone
from missions.services import TargetRequest, make_plan
from planning.problem import Objective
from planning.request import NO_BATTERY, EndAction
from tests.exact_geometry import segment_meets_polygon
from tests.missions.property_tests.random_missions import AMPLE
from tests.missions.worlds import rebuild, request, uav, world

pytestmark = pytest.mark.django_db

east = st.floats(9.99, 10.03)
north = st.floats(55.985, 56.02)
place = st.tuples(east, north)


@st.composite
def triangles(draw: Any) -> list[tuple[float, float]]:
    lon, lat = draw(place)
    size = draw(st.floats(0.0003, 0.008))
    return [(lon, lat), (lon + size, lat + draw(st.floats(-0.004, 0.004))), (lon + size / 3, lat + size)]


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    zones=st.lists(triangles(), max_size=5),
    starts=st.lists(place, min_size=1, max_size=2),
    spots=st.lists(place, max_size=2),
    picks=st.lists(st.integers(0, 8), min_size=1, max_size=3),
    action=st.sampled_from(list(EndAction)),
    objective=st.sampled_from(list(Objective)),
)
def test_no_leg_of_any_plan_meets_a_zone(
    zones: list[list[tuple[float, float]]],
    starts: list[tuple[float, float]],
    spots: list[tuple[float, float]],
    picks: list[int],
    action: EndAction,
    objective: Objective,
) -> None:
    if not Asset.objects.exists():
        world()
    assets = list(Asset.objects.order_by("pk"))
    NoFlyZone.objects.all().delete()
    for number, corners in enumerate(zones):
        shape = MultiPolygon(Polygon([*corners, corners[0]]), srid=4326)
        NoFlyZone.objects.create(identifier=f"z{number}", name=f"Zone {number}", geometry=shape)
    rebuild()
    targets = [TargetRequest(assets[pick].pk) for pick in picks] + [TargetRequest(None, uav(spot).position) for spot in spots]
    battery = AMPLE if objective is Objective.ENERGY else NO_BATTERY
    uavs = tuple(uav(start, name=f"U{number}", end_action=action, performance=battery) for number, start in enumerate(starts))
    plan = make_plan(request=request(*targets, uavs=uavs, objective=objective))
    for route in plan["routes"]:
        for start, end in pairwise(tuple(waypoint["position"]) for waypoint in route["waypoints"]):
            assert not any(segment_meets_polygon(start, end, [corners]) for corners in zones)
    done = [target for route in plan["routes"] for target in route["targets"]] + [item["target"] for item in plan["unassigned"]]
    assert sorted(done) == list(range(len(targets)))
