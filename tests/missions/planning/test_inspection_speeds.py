"""Lines that are inspected at a speed of their own: in the plan's times, the approved route, the items of an autopilot, and the API."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from django.test import Client
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat, distance_m
from mavlink.mission_items import flight_loads
from missions.models import Mission
from missions.services import TargetRequest, create_mission, plan_mission
from missions.services.approval.document import frozen_route
from missions.services.commands.flight_progress import FlightEnd, mark_flight_ended
from planning.problem import Objective
from planning.request import EndAction
from planning.task import Task, TaskKind
from tests.accounts.users import a_user, client_of
from tests.inspection.ground import tower
from tests.missions.api import mission_body, post
from tests.missions.flights import fleet, ground
from tests.missions.replanning.in_flight import started
from tests.missions.worlds import World, power_line, rebuild, request, uav, world
from workspace.models import Role

pytestmark = pytest.mark.django_db

SLOW_MPS = 4.0


@pytest.fixture
def here() -> World:
    return world()


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.OPERATOR))


def planned(client: Client, *targets: dict[str, Any], **more: Any) -> Mission:
    answer = post(client, "missions", mission_body(*targets, plan=True, **more))
    assert answer.status_code == 201, answer.json()
    return Mission.objects.get(pk=answer.json()["id"])


def looked_at(asset: int, speed_mps: float | None) -> dict[str, Any]:
    return {"asset": asset, "task": {"kind": "look", "hold_s": 0, "speed_mps": speed_mps}}


def legs_along(mission: Mission, target: int = 0) -> list[tuple[float, float]]:
    """Metres and seconds of each leg along the target's stretch."""
    rows = list(mission.routes.get(geometry__isnull=False).waypoints.select_related("target"))
    along = [row for row in rows if row.target is not None and row.target.sequence == target]
    return [
        (
            float(distance_m(np.array([before.position.coords[:2]]), np.array([after.position.coords[:2]]))[0]),
            (after.arrival_s or 0.0) - (before.arrival_s or 0.0),
        )
        for before, after in pairwise(along)
    ]


def test_the_line_is_flown_at_its_speed_and_the_way_there_as_ever(here: World, client: Client) -> None:
    usual, slow = planned(client, looked_at(here.line.pk, None)), planned(client, looked_at(here.line.pk, SLOW_MPS))
    metres, seconds = np.array(legs_along(slow)).sum(axis=0)
    assert metres > 1_000
    assert metres / seconds == pytest.approx(SLOW_MPS, rel=0.03)
    usual_m, usual_s = np.array(legs_along(usual)).sum(axis=0)
    assert usual_m / usual_s > 2 * SLOW_MPS
    longer_s = slow.routes.get(geometry__isnull=False).duration_s - usual.routes.get(geometry__isnull=False).duration_s
    assert longer_s == pytest.approx(seconds - usual_s, abs=5.0)


def test_the_approved_route_and_the_autopilot_have_the_speed_on_those_legs_alone(here: World, client: Client) -> None:
    mission = planned(client, looked_at(here.line.pk, SLOW_MPS))
    route = frozen_route(mission.routes.get(geometry__isnull=False), mission)
    slowly = [own.sequence for own in route.waypoints if own.speed_mps == SLOW_MPS]
    own = [place for place, waypoint in enumerate(route.waypoints) if waypoint.target == 0]
    assert slowly == [route.waypoints[place].sequence for place in own[1:]]
    assert all(waypoint.speed_mps in {None, SLOW_MPS} for waypoint in route.waypoints)
    items = flight_loads(route)[0].mission
    speeds = [item.parameters[1] for item in items if item.command == mavlink.MAV_CMD_DO_CHANGE_SPEED]
    assert speeds == [route.cruise_speed_mps, SLOW_MPS, route.cruise_speed_mps]


def test_a_uav_that_flies_slower_keeps_its_own_speed(here: World, client: Client) -> None:
    mission = planned(client, looked_at(here.line.pk, 30.0))
    assert legs_along(mission) == legs_along(planned(client, looked_at(here.line.pk, None)))
    route = frozen_route(mission.routes.get(geometry__isnull=False), mission)
    assert all(waypoint.speed_mps is None for waypoint in route.waypoints)


def test_the_speed_is_kept_shown_and_copied(here: World, client: Client) -> None:
    mission = planned(client, looked_at(here.line.pk, SLOW_MPS))
    assert client.get(f"/api/v1/missions/{mission.pk}").json()["targets"][0]["task"]["speed_mps"] == SLOW_MPS
    copy = post(client, f"missions/{mission.pk}/duplicate").json()
    assert copy["targets"][0]["task"] == {"kind": "look", "hold_s": 0.0, "speed_mps": SLOW_MPS}


@pytest.mark.parametrize(
    ("task", "place"),
    [
        ({"kind": "photo", "speed_mps": 4}, "line"),
        ({"kind": "look", "speed_mps": 0}, "line"),
        ({"kind": "look", "speed_mps": 51}, "line"),
        ({"kind": "look", "speed_mps": 4}, "position"),
        ({"kind": "look", "speed_mps": 4}, "tower"),
    ],
)
def test_what_cannot_be_is_refused(here: World, client: Client, task: dict[str, Any], place: str) -> None:
    target = {"asset": here.line.pk, "task": task} | ({"position": [10.008, 56.0]} if place == "position" else {})
    target |= {"asset": here.towers[0].pk} if place == "tower" else {}
    answer = post(client, "missions", mission_body(target, plan=True))
    assert answer.status_code == 400
    assert any("task" in where for where in answer.json()["error"]["details"])


def test_such_a_route_is_not_changed_by_hand(here: World, client: Client) -> None:
    mission = planned(client, looked_at(here.line.pk, SLOW_MPS))
    row = mission.routes.get(geometry__isnull=False)
    points = [
        {"position": list(waypoint.position.coords[:2]), "altitude_agl_m": waypoint.altitude_agl_m, "was": place}
        for place, waypoint in enumerate(row.waypoints.all())
    ]
    answer = post(client, f"missions/{mission.pk}/routes/{row.mission_uav.sequence}/waypoints/look", {"waypoints": points})
    assert "inspection speed" in str(answer.json())


def test_what_is_left_of_a_line_is_flown_at_its_speed_after_planning_again_in_flight(here: World, tmp_path: Path) -> None:
    """Each of two UAVs inspects a half of a line. One fails; the other, in the middle of its half, gets the rest, too."""
    ground(tmp_path / "hill.tif", 100.0)
    author, uavs = a_user(), fleet("Tern", "Kite")
    towers = [tower((11.0 + 0.005 * number, 56.0)) for number in range(13)]
    line = power_line(towers, voltages_v=[110_000])
    rebuild()
    ends = [LonLat(*towers[number].centre.coords) for number in (0, 6, 12)]
    task = Task(TaskKind.LOOK, 0.0, speed_mps=SLOW_MPS)
    targets = tuple(TargetRequest(asset=line.pk, stretch=part, task=task) for part in pairwise(ends))
    starts = [(10.999, 55.997), (11.061, 55.997)]
    asked = tuple(
        replace(uav(start, name=own.name, end_action=EndAction.RETURN), uav=own.pk) for start, own in zip(starts, uavs, strict=True)
    )
    wished = replace(request(uavs=asked, objective=Objective.MAKESPAN), targets=targets)
    draft = create_mission(organisation=author.organisation, author=author, name="Halves", request=wished)
    flight = started(author, uavs, plan_mission(mission=draft, actor=author))
    mark_flight_ended(mission_id=flight.mission.pk, uav_id=uavs[0].pk, flight=1, end=FlightEnd.FAILED)
    rows = list(flight.route(1).waypoints.select_related("target"))
    along = [place for place, row in enumerate(rows) if row.target is not None]
    flight.fly_to(1, along[2], 0.5)
    offer = flight.offer()
    assert offer.continuation is not None, offer.outcome

    route = offer.continuation.routes.get(mission_uav__name="Kite")
    frozen = frozen_route(route, offer.continuation)
    assert frozen.begun_by is not None
    assert [own.speed_mps for own in frozen.waypoints[:3]] == [None, SLOW_MPS, SLOW_MPS], "it is on the line already"
    slow = [(before, after) for before, after in pairwise(frozen.waypoints) if after.speed_mps == SLOW_MPS]
    flown = [
        (float(distance_m(np.array([before.position]), np.array([after.position]))[0]), (after.arrival_s or 0) - (before.arrival_s or 0))
        for before, after in slow
    ]
    metres, seconds = np.array(flown).sum(axis=0)
    assert metres > 3_000
    assert metres / seconds == pytest.approx(SLOW_MPS, rel=0.05)
