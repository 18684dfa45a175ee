"""When a mission may depart, over HTTP."""

from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from django.test import Client

from inspection.models import NoFlyZone
from inspection.services import mark_ground_changed
from missions.models import Mission, Route, Waypoint
from tests.accounts.users import a_user, client_of
from tests.missions.api import mission_body, plan_body, post
from tests.missions.test_stale_zones import hours
from tests.missions.worlds import World, zone_around
from workspace.models import Role

pytestmark = pytest.mark.django_db

TODAY = datetime.now(UTC).replace(hour=0, minute=0, second=0, microsecond=0)
SUNDAY = TODAY + timedelta(days=6 - TODAY.weekday())
MONDAY, TUESDAY = SUNDAY + timedelta(days=1), SUNDAY + timedelta(days=2)
TIME_MARGIN = timedelta(minutes=5)


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.VIEWER))


def zone(name: str = "Fire brigade", **facts: Any) -> NoFlyZone:
    row = zone_around((10.012, 56.0), name=name, with_graph=False)
    NoFlyZone.objects.filter(pk=row.pk).update(**facts)
    mark_ground_changed()
    return row


def planned(here: World) -> dict[str, Any]:
    """Waypoint k is reached k + 1 min after departure."""
    made = post(client_of(a_user(Role.OPERATOR)), "missions", mission_body(here.towers[1], here.towers[5], plan=True)).json()
    for waypoint in Waypoint.objects.all():
        Waypoint.objects.filter(pk=waypoint.pk).update(arrival_s=60.0 * (waypoint.sequence + 1))
    Route.objects.update(departs_s=0.0, duration_s=60.0 * (Waypoint.objects.count() + 1))
    return made


def asked(client: Client, mission: dict[str, Any], begin: str = SUNDAY.isoformat()) -> dict[str, Any]:
    response = client.get(f"/api/v1/missions/{mission['id']}/legal-windows", {"from": begin})
    assert response.status_code == 200, response.content
    return response.json()


def moments(span: dict[str, str]) -> tuple[datetime, datetime]:
    return datetime.fromisoformat(span["from"]), datetime.fromisoformat(span["to"])


def test_without_a_zone_every_departure_is_legal(here: World, client: Client) -> None:
    found = asked(client, planned(here))
    whole = {"from": f"{SUNDAY:%Y-%m-%dT%H:%M:%SZ}", "to": f"{TUESDAY:%Y-%m-%dT%H:%M:%SZ}"}
    assert found == whole | {"margin_s": 300.0, "height_margin_m": 10.0, "windows": [whole], "zones": []}


def test_a_zone_bars_the_departures_that_would_meet_it(here: World, client: Client) -> None:
    mission = planned(here)
    row = zone(schedule=hours("MON", "09:00", "10:00"))
    found = asked(client, mission)
    [named] = found["zones"]
    legs = [leg["leg"] for leg in named["legs"]]
    assert (named["id"], named["name"], named["schedule_in_words"]) == (row.pk, "Fire brigade", "Mon 09:00 to 10:00 UTC")
    assert {leg["uav"] for leg in named["legs"]} == {0}
    assert legs == list(range(legs[0], legs[-1] + 1))
    [blocked] = named["blocked"]
    begins, ends = (MONDAY + timedelta(hours=9)) - TIME_MARGIN, (MONDAY + timedelta(hours=10)) + TIME_MARGIN
    assert moments(blocked) == (begins - timedelta(minutes=legs[-1] + 2), ends - timedelta(minutes=legs[0] + 1))
    assert [moments(window) for window in found["windows"]] == [
        (SUNDAY, moments(blocked)[0]),
        (moments(blocked)[1], TUESDAY),
    ]


def test_departing_in_a_window_meets_nothing_and_departing_before_it_does(here: World, client: Client) -> None:
    """The page of stale missions is asked, which judges each leg by itself."""
    mission = planned(here)
    zone(schedule=hours("MON", "09:00", "10:00"))
    (_, blocked_from), (blocked_to, _) = (moments(window) for window in asked(client, mission)["windows"])
    for departs_at, is_met in (
        (blocked_from - timedelta(seconds=2), False),
        (blocked_from + timedelta(seconds=2), True),
        (blocked_to - timedelta(seconds=2), True),
        (blocked_to + timedelta(seconds=2), False),
    ):
        Mission.objects.update(departs_at=departs_at)
        found = client.get(f"/api/v1/missions/{mission['id']}").json()["stale_causes"]
        assert [cause["what"] for cause in found] == (["zone"] if is_met else ["elsewhere"])


def test_a_permanent_zone_bars_all_and_one_above_the_flight_nothing(here: World, client: Client) -> None:
    mission = planned(here)
    zone(lower_limit_m=200.0, lower_reference="AGL")
    assert asked(client, mission)["zones"] == []
    zone("Airport")
    found = asked(client, mission)
    assert found["windows"] == []
    assert [(named["name"], named["schedule_in_words"]) for named in found["zones"]] == [("Airport", "Always")]


def test_of_a_plan_without_times_a_leg_may_be_at_any_time_of_its_route(here: World, client: Client) -> None:
    plan = post(client_of(a_user(Role.OPERATOR)), "plans", plan_body(here.towers[1], here.towers[5])).json()
    [route] = plan["routes"]
    zone(schedule=hours("MON", "09:00", "10:00"))
    response = post(client, "plans/legal-windows", {"from": SUNDAY.isoformat(), "routes": [route | {"arrival_s": [], "departs_s": 30.0}]})
    assert response.status_code == 200, response.content
    [blocked] = response.json()["zones"][0]["blocked"]
    begins, ends = moments(blocked)
    lasts = (MONDAY + timedelta(hours=9)) - TIME_MARGIN - begins
    assert lasts == timedelta(seconds=int(-(-(30.0 + route["duration_s"]) // 1)))
    assert ends == (MONDAY + timedelta(hours=10)) + TIME_MARGIN - timedelta(seconds=30)


@pytest.mark.parametrize(
    "route",
    [
        7,
        {},
        {"end_action": "hover", "duration_s": 10.0, "arrival_s": [1.0], "waypoints": []},
        {"end_action": "hover", "duration_s": -1.0, "arrival_s": [], "waypoints": []},
        {"end_action": "dance", "duration_s": 10.0, "arrival_s": [], "waypoints": []},
        {"end_action": "hover", "duration_s": 10.0, "arrival_s": [], "waypoints": [{"position": [200.0, 0.0], "altitude_agl_m": 1.0}]},
        {"end_action": "hover", "duration_s": 10.0, "arrival_s": [], "waypoints": [{"position": [2.0, 0.0], "altitude_agl_m": None}]},
        {"end_action": "hover", "duration_s": 10.0, "arrival_s": [], "waypoints": [{"position": [2.0, 0.0], "altitude_agl_m": "1"}]},
        {"end_action": "hover", "duration_s": 10.0, "arrival_s": "soon", "waypoints": [{"position": [2.0, 0.0], "altitude_agl_m": 1}]},
    ],
)
def test_what_is_no_route_is_refused(client: Client, route: Any) -> None:
    response = post(client, "plans/legal-windows", {"routes": [route]})
    assert (response.status_code, list(response.json()["error"]["details"])) == (400, ["routes.0"])


def test_a_departure_that_is_no_time_is_refused(here: World, client: Client) -> None:
    mission = planned(here)
    for begin in ("tomorrow", "9999-12-31T23:00:00Z"):
        response = client.get(f"/api/v1/missions/{mission['id']}/legal-windows", {"from": begin})
        assert (response.status_code, list(response.json()["error"]["details"])) == (400, ["from"])


def test_a_mission_without_routes_has_no_windows(here: World, client: Client) -> None:
    draft = post(client_of(a_user(Role.OPERATOR)), "missions", mission_body(here.towers[1])).json()
    response = client.get(f"/api/v1/missions/{draft['id']}/legal-windows")
    assert (response.status_code, response.json()["error"]["code"]) == (409, "not_planned")


def test_the_shape_is_in_the_schema(client: Client) -> None:
    document = client.get("/api/schema", headers={"Accept": "application/vnd.oai.openapi+json"}).json()
    assert set(document["components"]["schemas"]["TimeSpan"]["properties"]) == {"from", "to"}
    shape = document["components"]["schemas"]["LegalWindows"]["properties"]
    assert set(shape) == {"from", "to", "margin_s", "height_margin_m", "windows", "zones"}
