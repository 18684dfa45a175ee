"""Campaigns: missions from several launch sites, the crews' days, and what is stored of them."""

import csv
from io import StringIO
from typing import Any
from unittest import mock

import pytest
from django.contrib.gis.geos import Point
from django.test import Client

from inspection.geodesy.wgs84 import WGS84
from missions import tasks
from missions.models import Campaign, Mission, MissionState, Uav, UavType
from missions.services import campaigns
from missions.services.planning.planner import make_plan
from planning.campaigns import campaign as planner
from planning.campaigns.crew_days import ROAD_FACTOR
from tests.accounts.users import a_user, client_of
from tests.missions.api import post
from tests.missions.worlds import TOWER_LONS, World, rebuild, world, zone_around
from workspace.models import Job, JobState, Organisation, Role

pytestmark = pytest.mark.django_db

START = [10.0, 55.99]
LINE_LAT = 56.0


@pytest.fixture
def here() -> World:
    return world()


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.OPERATOR))


def body(here: World, *more: Any, name: str = "Line 7", **rules: Any) -> dict[str, Any]:
    """All six towers of the line, 1.2 km, with a reach of 300 m: three sites."""
    return {
        "name": name,
        "uavs": [{"name": "Tern", "position": [10.001, 55.995]}],
        "targets": [*({"asset": tower.pk} for tower in here.towers), *more],
        "rules": {"start": START, "reach_m": 300.0} | rules,
    }


def a_stored_uav() -> Uav:
    unlimited = UavType.objects.create(name="Unlimited", range_unlimited=True)
    return Uav.objects.create(name="Kestrel", uav_type=unlimited, location=Point(10.001, 55.995, srid=4326))


def planned(client: Client, asked: dict[str, Any]) -> dict[str, Any]:
    answer = post(client, "campaigns", asked)
    assert answer.status_code == 202, answer.json()
    tasks.plan_campaign(answer.json()["job"])
    return client.get(f"/api/v1/campaigns/{answer.json()['id']}").json()


def distance_m(first: Any, second: Any) -> float:
    return WGS84.inv(*first, *second)[2]


def test_every_tower_is_visited_by_a_mission_from_a_site_within_reach(here, client):
    answer = planned(client, body(here))
    schedule = answer["schedule"]
    assert schedule["unassigned"] == []
    assert len(schedule["sites"]) == 2
    visited = []
    for row in schedule["missions"]:
        mission = Mission.objects.get(pk=row["mission"])
        site = schedule["sites"][row["site"]]["position"]
        assert (mission.state, row["state"], str(mission.campaign_id)) == (MissionState.PLANNED, "planned", answer["id"])
        assert mission.name == f"Line 7 · {row['number']}"
        route = mission.routes.get()
        assert distance_m(route.geometry.coords[0][:2], site) < 0.1
        assert distance_m(route.geometry.coords[-1][:2], site) < 0.1
        assert row["length_m"] == round(route.length_m)
        assert row["work_s"] == round(route.departs_s + route.duration_s)
        assert row["farthest_m"] == pytest.approx(max(distance_m(point[:2], site) for point in route.geometry.coords), abs=0.6)
        for target in mission.targets.all():
            assert target.unassigned_reason == ""
            assert distance_m(target.place.coords, site) <= 300.0
            visited.append(target.asset_id)
    assert sorted(visited) == sorted(tower.pk for tower in here.towers)


def test_the_days_add_up(here, client):
    schedule = planned(client, body(here, drive_kmh=36.0, set_up_min=10.0))["schedule"]
    (day,) = schedule["days"]
    by_number = {row["number"]: row for row in schedule["missions"]}
    assert [visit["mission"] for visit in day["visits"]] == [1, 2]
    at, clock_s = START, 0.0
    for visit in day["visits"]:
        site = schedule["sites"][by_number[visit["mission"]]["site"]]["position"]
        drive_m = distance_m(at, site) * ROAD_FACTOR
        assert visit["drive_m"] == pytest.approx(drive_m, abs=1.0)
        assert visit["arrives_s"] == pytest.approx(clock_s + drive_m / 10.0, abs=2.0)
        clock_s = visit["arrives_s"] + 600.0 + by_number[visit["mission"]]["work_s"]
        assert visit["leaves_s"] == pytest.approx(clock_s, abs=2.0)
        at = site
    assert day["ends_s"] == pytest.approx(clock_s + distance_m(at, START) * ROAD_FACTOR / 10.0, abs=3.0)


def test_the_days_as_a_table(here, client):
    answer = planned(client, body(here, name="=Line 7"))
    file = client.get(f"/api/v1/campaigns/{answer['id']}/days.csv")
    assert file["Content-Disposition"] == 'attachment; filename="line-7-days.csv"'
    first, second, back = list(csv.DictReader(StringIO(b"".join(file.streaming_content).decode())))
    visit = answer["schedule"]["days"][0]["visits"][0]
    assert (first["day"], first["crew"], first["mission"], first["name"], first["state"]) == ("1", "1", "1", "'=Line 7 · 1", "planned")
    assert first["site"] == "Launch site 1"
    assert [float(first["longitude"]), float(first["latitude"])] == answer["schedule"]["sites"][0]["position"]
    assert float(first["leaves_min"]) == round(visit["leaves_s"] / 60.0, 1)
    assert (second["mission"], back["mission"], back["site"]) == ("2", "", "Start")
    assert float(back["arrives_min"]) == round(answer["schedule"]["days"][0]["ends_s"] / 60.0, 1)
    waiting = post(client, "campaigns", body(here)).json()["id"]
    assert client.get(f"/api/v1/campaigns/{waiting}/days.csv").status_code == 409


def test_routes_as_geojson(here, client):
    answer = planned(client, body(here))
    routes = client.get(f"/api/v1/campaigns/{answer['id']}/routes").json()
    assert [feature["properties"] for feature in routes["features"]] == [
        {"number": row["number"], "day": 1, "uav": "Tern"} for row in answer["schedule"]["missions"]
    ]
    for feature, row in zip(routes["features"], answer["schedule"]["missions"], strict=True):
        stored = Mission.objects.get(pk=row["mission"]).routes.get().geometry.coords
        assert feature["geometry"]["coordinates"] == [list(point[:2]) for point in stored]


def test_work_that_does_not_fit_a_day_is_split(here, client):
    """A working day that holds the drive, the set-up and some minutes of flying: six towers from one site take several days."""
    rules = {"day_h": 1.0, "set_up_min": 51.0, "reach_m": 5_000.0, "drive_kmh": 60.0}
    schedule = planned(client, body(here, **rules))["schedule"]
    assert len(schedule["sites"]) == 1
    assert len(schedule["missions"]) > 1
    assert all(day["ends_s"] <= 3_600 for day in schedule["days"])
    assert sum(row["targets"] for row in schedule["missions"]) == 6
    assert [row["is_too_long"] for row in schedule["missions"]] == [False] * len(schedule["missions"])


def test_targets_whose_drive_takes_the_day_are_named(here, client):
    schedule = planned(client, body(here, day_h=1.0, set_up_min=59.0, reach_m=5_000.0, drive_kmh=60.0))["schedule"]
    assert (schedule["days"], schedule["missions"]) == ([], [])
    assert {item["reason"] for item in schedule["unassigned"]} == {"beyond_working_day"}


def test_a_later_mission_flies_what_the_batteries_of_one_do_not_hold(here, client):
    asked = body(here, flights=1, reach_m=5_000.0)
    asked["uavs"] = [{"name": "Tern", "position": [10.0, 56.0], "max_range_m": 2_000.0}]
    schedule = planned(client, asked)["schedule"]
    assert schedule["unassigned"] == []
    assert len(schedule["missions"]) > 1
    lengths_m = [Mission.objects.get(pk=row["mission"]).routes.get().length_m for row in schedule["missions"]]
    assert max(lengths_m) <= 2_000.0
    stored = [target.asset_id for row in schedule["missions"] for target in Mission.objects.get(pk=row["mission"]).targets.all()]
    assert sorted(stored) == sorted(tower.pk for tower in here.towers)  # a mission holds what it visits, and nothing else


def test_targets_that_no_mission_visits_are_named_with_the_reason(here, client):
    zone_around((TOWER_LONS[2], LINE_LAT))
    far = {"position": [10.2, 56.0]}
    asked = body(here, far, proposes_sites=False, sites=[{"name": "Yard", "position": [10.005, 55.998]}], reach_m=1_500.0)
    schedule = planned(client, asked)["schedule"]
    unassigned = {item["target"]: item for item in schedule["unassigned"]}
    assert unassigned[6]["reason"] == "beyond_reach"
    assert "UAVs would have to fly up to" in unassigned[6]["message"]
    assert unassigned[2]["reason"] == "inside_zone"
    assert "Airport" in unassigned[2]["message"]
    assert schedule["sites"] == [{"name": "Yard", "position": [10.005, 55.998], "is_required": False}]


def test_no_site_is_inside_a_zone(here, client):
    for lon in TOWER_LONS[::2]:
        zone_around((lon, LINE_LAT), 0.0005, with_graph=lon == TOWER_LONS[4])
    schedule = planned(client, body(here, sites=[{"name": "Inside", "position": [TOWER_LONS[0], LINE_LAT]}]))["schedule"]
    assert all(site["name"] != "Inside" for site in schedule["sites"])
    assert [site["name"] for site in schedule["blocked_sites"]] == ["Inside"]
    places = [site["position"] for site in schedule["sites"]]
    assert places
    assert all(distance_m(place, (lon, LINE_LAT)) > 30.0 for place in places for lon in TOWER_LONS[::2])


def test_proposed_sites_are_clear_of_towers_and_wires(here, client):
    for site in planned(client, body(here))["schedule"]["sites"]:
        assert min(distance_m(site["position"], tower.centre.coords) for tower in here.towers) == pytest.approx(40.0, abs=0.1)
        is_beside_wires = TOWER_LONS[0] < site["position"][0] < TOWER_LONS[-1]
        assert not is_beside_wires or abs(site["position"][1] - LINE_LAT) * 111_000.0 > 25.0


def test_uavs_of_several_flights_that_hover_at_their_end_return_in_a_campaign(here, client):
    asked = body(here)
    asked["uavs"][0] |= {"sorties": 3, "end_action": "hover"}
    schedule = planned(client, asked)["schedule"]
    assert {Mission.objects.get(pk=row["mission"]).mission_uavs.get().end_action for row in schedule["missions"]} == {"return"}


def test_figures_and_ids_of_other_systems_come_into_the_missions(here, client):
    uav = a_stored_uav()
    asked = body(here)
    asked["uavs"] = [{"id": uav.pk, "position": [10.001, 55.995], "max_range_m": 5_000.0}]
    asked["targets"][0] |= {"external_id": "WO-7", "attributes": {"team": "North"}}
    rows = [Mission.objects.get(pk=row["mission"]) for row in planned(client, asked)["schedule"]["missions"]]
    assert all(row.mission_uavs.get().own_figures == ["max_range_m"] for row in rows)
    assert all(row.mission_uavs.get().uav_id == uav.pk for row in rows)
    assert [(t.external_id, t.attributes) for row in rows for t in row.targets.all() if t.asset_id == here.towers[0].pk] == [
        ("WO-7", {"team": "North"})
    ]


def test_no_stored_uav_is_with_two_crews(here, client):
    uav = a_stored_uav()
    asked = body(here, crews=2, day_h=1.0, set_up_min=50.0, drive_kmh=60.0)
    asked["uavs"] = [{"id": uav.pk, "position": [10.001, 55.995]}]
    schedule = planned(client, asked)["schedule"]
    crews = {visit["mission"]: day["crew"] for day in schedule["days"] for visit in day["visits"]}
    assert set(crews.values()) == {1, 2}
    for row in schedule["missions"]:
        of_mission = Mission.objects.get(pk=row["mission"]).mission_uavs.get()
        assert of_mission.uav_id == (uav.pk if crews[row["number"]] == 1 else None)


def test_uavs_and_assets_that_were_deleted_meanwhile_do_not_stop_it(here, client):
    uav = a_stored_uav()
    asked = body(here)
    asked["uavs"] = [{"id": uav.pk, "position": [10.001, 55.995]}]
    answer = post(client, "campaigns", asked).json()
    uav.delete()
    gone = here.towers[0].pk
    here.line.delete()
    here.towers[0].delete()
    rebuild()
    tasks.plan_campaign(answer["job"])
    schedule = client.get(f"/api/v1/campaigns/{answer['id']}").json()["schedule"]
    assert [(item["target"], item["reason"]) for item in schedule["unassigned"] if item["target"] == 0] == [(0, "asset_gone")]
    assert not Mission.objects.filter(targets__asset_id=gone).exists()


def test_deleted_while_it_is_planned_its_job_is_cancelled(here, client):
    answer = post(client, "campaigns", body(here)).json()
    assert client.delete(f"/api/v1/campaigns/{answer['id']}").status_code == 204
    assert Job.objects.get(pk=answer["job"]).state == JobState.CANCELLED
    assert post(client, f"campaigns/{answer['id']}/plan", {"rules": answer["rules"]}).status_code == 404


def test_an_organisation_has_two_campaigns_planned_at_a_time(here, client):
    for name in ("North", "South"):
        assert post(client, "campaigns", body(here, name=name)).status_code == 202
    assert post(client, "campaigns", body(here, name="East")).status_code == 429
    assert Campaign.objects.count() == 2


def test_planned_again_the_missions_are_replaced_unless_one_is_approved(here, client):
    first = planned(client, body(here))
    answer = post(client, f"campaigns/{first['id']}/plan", {"rules": first["rules"] | {"reach_m": 5_000.0}})
    assert answer.status_code == 202
    tasks.plan_campaign(answer.json()["job"])
    second = client.get(f"/api/v1/campaigns/{first['id']}").json()
    assert len(second["schedule"]["missions"]) == 1
    assert Mission.objects.filter(campaign=first["id"], deleted_at=None).count() == 1
    Mission.objects.filter(campaign=first["id"], deleted_at=None).update(state=MissionState.APPROVED)
    answer = post(client, f"campaigns/{first['id']}/plan", {"rules": first["rules"]})
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "missions_in_use")


def test_a_mission_that_is_approved_meanwhile_stays_and_nothing_is_stored(here, client):
    first = planned(client, body(here))
    answer = post(client, f"campaigns/{first['id']}/plan", {"rules": first["rules"] | {"reach_m": 5_000.0}}).json()
    Mission.objects.filter(campaign=first["id"]).update(state=MissionState.APPROVED)
    tasks.plan_campaign(answer["job"])
    assert Job.objects.get(pk=answer["job"]).error["code"] == "missions_in_use"
    assert client.get(f"/api/v1/campaigns/{first['id']}").json()["schedule"]["missions"] == [
        row | {"state": "approved"} for row in first["schedule"]["missions"]
    ]


def test_a_stopped_job_stores_nothing_and_a_second_one_waits_for_it(here, client):
    answer = post(client, "campaigns", body(here)).json()
    again = post(client, f"campaigns/{answer['id']}/plan", {"rules": answer["rules"]})
    assert (again.status_code, again.json()["error"]["code"]) == (409, "campaign_is_planned")
    plan = mock.Mock(side_effect=lambda **asked: make_plan(request=asked["request"]))
    with mock.patch.object(campaigns, "make_plan", plan), mock.patch.object(tasks.JobWatch, "stop", lambda watch: plan.called):
        tasks.plan_campaign(answer["job"])
    assert plan.call_count == 1
    assert Job.objects.get(pk=answer["job"]).state == JobState.CANCELLED
    assert not Mission.objects.exists()
    assert client.get(f"/api/v1/campaigns/{answer['id']}").json()["schedule"] is None


def test_too_many_missions_are_refused(here, client, monkeypatch):
    monkeypatch.setattr(planner, "MAX_MISSIONS", 1)
    answer = post(client, "campaigns", body(here)).json()
    tasks.plan_campaign(answer["job"])
    assert Job.objects.get(pk=answer["job"]).error["code"] == "too_many_missions"
    assert not Mission.objects.exists()


def test_deleted_with_its_missions_except_those_that_are_approved(here, client):
    answer = planned(client, body(here))
    approved = answer["schedule"]["missions"][0]["mission"]
    Mission.objects.filter(pk=approved).update(state=MissionState.APPROVED)
    assert client.delete(f"/api/v1/campaigns/{answer['id']}").status_code == 204
    assert not Campaign.objects.exists()
    assert [str(key) for key in Mission.objects.filter(deleted_at=None).values_list("pk", flat=True)] == [approved]


@pytest.mark.parametrize(
    ("rules", "place"),
    [
        ({"reach_m": -1}, "rules.reach_m"),
        ({"start": [10.0, 95.0]}, "rules.start"),
        ({"day_h": float("inf")}, "rules.day_h"),
        ({"crews": 0}, "rules.crews"),
        ({"proposes_sites": False}, "rules.sites"),
        ({"reachm": 3}, "rules.reachm"),
    ],
)
def test_bad_rules_are_refused_at_once(here, client, rules, place):
    answer = post(client, "campaigns", body(here, **rules))
    assert answer.status_code == 400
    assert not Campaign.objects.exists()
    if "inf" not in str(rules):
        assert place in answer.json()["error"]["details"]


def test_lists_its_organisations_campaigns_alone(here, client):
    answer = planned(client, body(here))
    rows = client.get("/api/v1/campaigns", {"text": "line"}).json()["results"]
    assert [(row["id"], row["mission_count"], row["day_count"], row["target_count"]) for row in rows] == [(answer["id"], 2, 1, 6)]
    other = client_of(a_user(Role.OPERATOR, Organisation.objects.create(name="Others")))
    assert other.get("/api/v1/campaigns").json()["results"] == []
    assert other.get(f"/api/v1/campaigns/{answer['id']}").status_code == 404
    viewer = client_of(a_user(Role.VIEWER))
    assert viewer.get(f"/api/v1/campaigns/{answer['id']}").status_code == 200
    assert viewer.delete(f"/api/v1/campaigns/{answer['id']}").status_code == 403
