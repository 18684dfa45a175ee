"""Random rests of missions, with zones that come while they fly: the offers are safe, by independent judges."""

import random
from collections import Counter
from typing import Any

import numpy as np
import pytest

from inspection.geodesy import LonLat
from inspection.models import Asset, NoFlyZone
from inspection.selectors import current_graph
from inspection.services import build_graph, mark_ground_changed
from missions.models import Mission, OfferState, ReplanOffer, Route
from missions.services import PlanRequest, TargetRequest, UavRequest, create_mission, plan_mission
from missions.services.commands.flight_progress import FlightEnd, mark_flight_ended
from missions.services.commands.refused import Refused
from missions.services.replanning import accept_offer
from planning.problem import Objective
from planning.request import EndAction
from tests.accounts.users import a_user
from tests.cases import long
from tests.inspection import ground as ground_rows
from tests.missions.flights import fleet
from tests.missions.oracles.zone_oracle import ZoneJudge, legs_of
from tests.missions.plane import apart_m
from tests.missions.property_tests.random_flights import bring_in
from tests.missions.replanning.in_flight import Flight, started

pytestmark = pytest.mark.django_db
UAVS, TARGETS, NEAR_DEG = 3, 9, 0.03


@pytest.mark.long
@pytest.mark.parametrize(
    ("seeds", "most_offers"), [pytest.param(range(8, 20), 2, id="few"), pytest.param(range(60), 60, id="many", marks=pytest.mark.long)]
)
@pytest.mark.parametrize("file_name", ["elme-valley.osm.pbf", *long("columbus-ohio.osm.pbf")])
def test_continued_routes_cross_no_zone_and_lose_no_target(
    region_file: Any, file_name: str, tmp_path: Any, seeds: range, most_offers: int
) -> None:
    hills = bring_in(region_file(file_name), tmp_path, random.Random(5), is_hilly=True)
    assert hills is not None
    build_graph()
    author, seen = a_user(), Counter()
    for number in seeds:
        draw = random.Random(number)
        NoFlyZone.objects.all().delete()
        mark_ground_changed()
        Mission.objects.filter(state__in=["active", "dispatched", "approved"]).update(state="aborted")
        flight = _flight(author, draw, number)
        if flight is None:
            continue
        out = None
        if draw.random() < 0.6:
            out = draw.randrange(UAVS)
            mark_flight_ended(mission_id=flight.mission.pk, uav_id=flight.uavs[out].pk, flight=1, end=FlightEnd.FAILED)
        _put_zone(flight, draw)
        offer = flight.offer()
        seen[offer.state] += 1
        if offer.state == OfferState.OPEN:
            assert not list(_faults(flight, offer, out)), number
            accept_offer(offer=offer, actor=author)
        if seen[OfferState.OPEN] == most_offers:
            break
    assert seen[OfferState.OPEN] >= min(most_offers, len(seeds) // 5), seen


def _flight(author: Any, draw: random.Random, number: int) -> Flight | None:
    """Three UAVs somewhere on their routes; None where the dice make a mission that nobody may fly."""
    centre = draw.choice(np.array(current_graph().position).tolist())
    towers = [
        tower
        for tower in Asset.objects.filter(kind="tower").order_by("pk")
        if max(abs(tower.centre.x - centre[0]), abs(tower.centre.y - centre[1])) < NEAR_DEG
    ]
    if len(towers) < TARGETS:
        return None
    uavs = fleet(*(f"UAV {number}-{place}" for place in range(UAVS)))
    asked = tuple(
        UavRequest(
            uav.name,
            LonLat(centre[0] + draw.uniform(-0.02, 0.02), centre[1] + draw.uniform(-0.02, 0.02)),
            None,
            12.0,
            draw.choice([EndAction.RETURN, EndAction.RETURN, EndAction.HOVER, EndAction.LAND]),
            uav=uav.pk,
        )
        for uav in uavs
    )
    targets = tuple(TargetRequest(tower.pk) for tower in draw.sample(towers, TARGETS))
    request = PlanRequest(asked, targets, Objective.MAKESPAN, return_to_start=False)
    draft = create_mission(organisation=author.organisation, author=author, name=f"Drawn {number}", request=request)
    mission = plan_mission(mission=draft, actor=author)
    if mission.routes.filter(geometry__isnull=False).count() < UAVS:
        return None
    try:
        flight = started(author, uavs, mission)
    except Refused:
        return None
    for place in range(UAVS):
        flight.fly_to(place, max(1, draw.randrange(flight.route(place).waypoints.count()) // 2), draw.random())
    return flight


def _put_zone(flight: Flight, draw: random.Random) -> None:
    """Around a place of a route that is still to come."""
    rows = list(flight.route(draw.randrange(UAVS)).waypoints.order_by("sequence"))
    at = draw.choice(rows[len(rows) // 2 :]).position
    ground_rows.zone((at.x + draw.uniform(-0.002, 0.002), at.y + draw.uniform(-0.002, 0.002)), draw.uniform(0.0005, 0.003), name="Sudden")
    mark_ground_changed()
    build_graph()


def _faults(flight: Flight, offer: ReplanOffer, out: int | None) -> Any:
    continuation, judge = offer.continuation, ZoneJudge()
    assert continuation is not None
    for route in continuation.routes.select_related("mission_uav"):
        rows = list(route.waypoints.order_by("sequence"))
        legs = legs_of(_as_plan(route, rows), continuation.departs_at, route.duration_s, {})[1:]  # it does not take off
        met = [zone.name for _leg, zone in judge.met(legs)]
        if met:
            yield f"{route.mission_uav.name} meets {met}"
        uav = route.mission_uav
        wrong = [row for row in rows if abs(row.altitude_relative_m - (row.altitude_amsl_m - uav.home_amsl_m)) > 0.02]
        if wrong:
            yield f"{uav.name} counts heights from elsewhere than its home"
        if uav.end_action == EndAction.RETURN and apart_m(rows[-1].position.coords[:2], uav.home.coords) > 1.0:
            yield f"{uav.name} does not return to its home"
        old = Route.objects.get(mission=flight.mission, mission_uav__uav=uav.uav_id)
        approved = {row.position.coords[:2] for row in old.waypoints.all()}
        kept = rows[1 : route.begun_by + 1]
        if any(row.position.coords[:2] not in approved for row in kept):
            yield f"{uav.name} begins on a way that nobody has approved"
    difference = offer.difference
    left = {target for uav in difference["uavs"] for target in (*uav["kept"], *uav["lost"])}
    after = Counter(target for uav in difference["uavs"] for target in uav["order"])
    unreached = {entry["target"] for entry in difference["targets"] if entry["to"] is None}
    if set(after) | unreached != left or any(count > 1 for count in after.values()) or set(after) & unreached:
        yield "a target is lost, or done twice"
    labels = Counter(continuation.targets.values_list("label", flat=True))
    ordered = [target for uav in difference["uavs"] if uav["change"] == "changed" for target in uav["order"]]
    if labels.total() != len(ordered):
        yield "the mission that is offered has other targets than are told"
    if out is not None and any(uav["place"] == out and uav["change"] != "out" for uav in difference["uavs"]):
        yield "a UAV whose flight failed flies on"


def _as_plan(route: Route, rows: list[Any]) -> dict[str, Any]:
    return {
        "end_action": route.mission_uav.end_action,
        "departs_s": route.departs_s,
        "duration_s": route.duration_s,
        "arrival_s": [row.arrival_s for row in rows],
        "charging": [],
        "waypoints": [
            {"position": row.position.coords[:2], "altitude_agl_m": row.altitude_agl_m, "altitude_amsl_m": row.altitude_amsl_m}
            for row in rows
        ],
    }
