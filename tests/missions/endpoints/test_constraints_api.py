"""Wishes over HTTP: in plans, in missions, and what is kept of them."""

from dataclasses import replace
from typing import Any

import pytest
from django.test import Client

from missions.models import Base, InspectionTarget, Mission
from tests.accounts.users import a_user, client_of
from tests.missions.api import TERN, mission_body, patch, plan_body, post, unlimited_type
from tests.missions.worlds import UAV_AT, World
from workspace.models import Job, JobState, Role

pytestmark = pytest.mark.django_db

QUALITY = {"lower_bound_m", "lower_bound_s", "lower_bound_wh", "gap", "is_proven", "gap_of", "method", "wish"}


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.OPERATOR))


def wishful(here: World, **more: Any) -> dict[str, Any]:
    """Three towers, of which the third and the first are locked in this order."""
    first, second, third = (tower.pk for tower in here.towers[:3])
    return plan_body(
        {"asset": first, "priority": "high", "sensor": "Lidar"},
        {"asset": second, "uav": "Tern"},
        {"asset": third, "priority": "low"},
        uavs=[TERN | {"most_targets": 3, "sensors": ["lidar"]}],
        locks=[{"uav": "Tern", "targets": [2, 0], "at_end": True}],
        **more,
    )


def faults(response: Any) -> list[str]:
    assert response.status_code == 400, response.content
    return list(response.json()["error"]["details"])


def test_a_plan_with_wishes_says_what_they_cost(here: World, client: Client) -> None:
    plan = post(client, "plans", wishful(here)).json()
    (route,) = plan["routes"]
    assert (route["targets"], route["locked"]) == ([1, 2, 0], [2, 0])
    assert set(plan) >= QUALITY
    assert set(plan["wish"]) == {"cost_m", "cost_s", "free_total_m", "free_longest_s", "left_out"}
    assert plan["locks"] == [{"uav": "Tern", "targets": [2, 0], "at_start": False, "at_end": True}]


@pytest.mark.parametrize(
    ("more", "place"),
    [
        ({"uavs": [TERN | {"most_targets": 0}]}, "uavs.0.most_targets"),
        ({"uavs": [TERN | {"sensors": "Lidar"}]}, "uavs.0.sensors"),
        ({"targets": [{"position": list(UAV_AT), "priority": "urgent"}]}, "targets.0.priority"),
        ({"targets": [{"position": list(UAV_AT), "uav": "Kite"}]}, "targets.0.uav"),
        ({"uavs": [TERN, TERN], "targets": [{"position": list(UAV_AT), "uav": "Tern"}]}, "targets.0.uav"),
        ({"locks": [{"uav": "Tern", "targets": []}]}, "locks.0.targets"),
        ({"locks": [{"uav": "Tern", "targets": [7]}]}, "locks.0.targets"),
        ({"locks": [{"targets": [0]}]}, "locks.0.uav"),
        ({"uavs": [TERN | {"end_action": "base"}]}, "uavs.0.end_action"),
    ],
)
def test_what_cannot_be_kept_is_refused_with_its_place(here: World, client: Client, more: dict[str, Any], place: str) -> None:
    assert faults(post(client, "plans", plan_body(here.towers[0]) | more)) == [place]
    mission = {"name": "North", "plan": True} | plan_body(here.towers[0]) | more
    assert faults(post(client, "missions", mission)) == [place]
    assert not Mission.objects.exists()


@pytest.mark.parametrize("locked", [[[0] * 6], [[0] * 2] * 3, [["x"] * 6], [[]] * 6], ids=["in one", "in all", "no numbers", "locks"])
def test_more_locked_targets_than_a_plan_may_have_are_refused_before_any_is_looked_at(
    here: World, client: Client, settings: Any, locked: list[list[Any]]
) -> None:
    settings.ROUTING_RULES = replace(settings.ROUTING_RULES, max_targets=5)
    body = plan_body(here.towers[0], locks=[{"uav": "Tern", "targets": targets} for targets in locked])
    answer = post(client, "plans", body)
    assert faults(answer) == ["locks"]
    assert "At most 5" in str(answer.json())
    assert faults(post(client, "missions", {"name": "North"} | body)) == ["locks"]


def test_a_stored_uav_brings_its_sensors(here: World, client: Client) -> None:
    kite = {"name": "Kite", "position": list(UAV_AT), "sensor": "Lidar", "type": unlimited_type(client)}
    uav = post(client, "uavs", kite).json()["id"]
    body = plan_body({"asset": here.towers[0].pk, "sensor": "lidar"})
    assert post(client, "plans", body | {"uavs": [{"id": uav}]}).json()["unassigned"] == []
    (left_out,) = post(client, "plans", body | {"uavs": [{"id": uav, "sensors": []}]}).json()["unassigned"]
    assert left_out["reason"] == "not_allowed"


def test_landing_is_at_a_base_of_the_own_organisation(here: World, client: Client) -> None:
    body = plan_body(here.towers[5]) | {"uavs": [TERN | {"end_action": "base"}]}
    assert faults(post(client, "plans", body)) == ["uavs.0.end_action"]
    assert post(client, "plans", body | {"return_to_start": True}).status_code == 200
    base = post(client, "bases", {"name": "North", "position": [10.0205, 56.0]}).json()
    plan = post(client, "plans", body).json()
    assert plan["routes"][0]["waypoints"][-1]["position"] == base["position"]


def test_a_mission_keeps_every_wish_and_the_quality_of_its_plan(here: World, client: Client) -> None:
    made = post(client, "missions", wishful(here, name="North", plan=True)).json()
    mission = client.get(f"/api/v1/missions/{made['id']}").json()
    assert (mission["uavs"][0]["most_targets"], mission["uavs"][0]["sensors"]) == (3, ["lidar"])
    wishes = [(target["priority"], target["uav"], target["sensor"]) for target in mission["targets"]]
    assert wishes == [("high", None, "Lidar"), ("normal", "Tern", ""), ("low", None, "")]
    assert mission["locks"] == mission["plan"]["locks"] == [{"uav": "Tern", "targets": [2, 0], "at_start": False, "at_end": True}]
    plan = post(client, "plans", wishful(here)).json()
    assert {name: mission["plan"][name] for name in QUALITY} == {name: plan[name] for name in QUALITY}
    assert mission["plan"]["routes"][0]["locked"] == plan["routes"][0]["locked"]

    copy = post(client, f"missions/{made['id']}/duplicate").json()
    for part in ("locks", "uavs", "targets", "plan"):
        assert copy[part] == mission[part]


def test_a_copy_is_planned_again_with_the_same_wishes(here: World, client: Client) -> None:
    made = post(client, "missions", wishful(here, name="North", plan=True)).json()
    copy = post(client, f"missions/{made['id']}/duplicate").json()
    again = post(client, f"missions/{copy['id']}/plan").json()
    assert again["plan"]["routes"][0]["targets"] == made["plan"]["routes"][0]["targets"]
    assert again["last_plan"]["locks"] == 1
    assert again["last_plan"]["quality"] == {name: made["plan"][name] for name in QUALITY}


def test_new_targets_drop_the_locks_that_named_the_old_ones(here: World, client: Client) -> None:
    made = post(client, "missions", wishful(here, name="North")).json()
    changed = patch(client, f"missions/{made['id']}", {"targets": [{"asset": here.towers[4].pk}]}).json()
    assert changed["locks"] == []
    history = client.get(f"/api/v1/missions/{made['id']}/history").json()["results"]
    assert (history[0]["before"]["locks"], history[0]["after"]["locks"]) == (1, 0)


def test_new_uavs_keep_the_locks_where_they_still_fit(here: World, client: Client) -> None:
    made = post(client, "missions", wishful(here, name="North")).json()
    tern = TERN | {"sensors": ["Lidar"]}
    kept = patch(client, f"missions/{made['id']}", {"uavs": [tern | {"cruise_speed_mps": 9.0}]}).json()
    assert kept["locks"] == made["locks"]
    assert faults(patch(client, f"missions/{made['id']}", {"uavs": [tern | {"name": "Kite"}]})) == ["targets.1.uav", "locks.0.uav"]


@pytest.mark.parametrize(
    ("most", "locked", "words"),
    [
        (1, [0, 1], "Tern may do 1 target at most, but 2 are locked to it."),
        (2, [0, 1, 2], "Tern may do 2 targets at most, but 3 are locked to it."),
    ],
)
def test_a_limit_below_what_is_locked_names_the_uav(here: World, client: Client, most: int, locked: list[int], words: str) -> None:
    wishes = {"uavs": [TERN | {"most_targets": most}], "locks": [{"uav": "Tern", "targets": locked}]}
    error = post(client, "plans", plan_body(*here.towers[:3]) | wishes).json()["error"]
    assert error["details"] == {"uavs.0.most_targets": [words]}


def test_where_there_is_no_base_the_uav_is_named(here: World, client: Client) -> None:
    error = post(client, "plans", plan_body(here.towers[0], uavs=[TERN | {"end_action": "base"}])).json()["error"]
    (words,) = error["details"]["uavs.0.end_action"]
    assert words.startswith("Tern is to land at a base, but there is none.")


def test_locks_are_changed_alone_and_drop_the_plan(here: World, client: Client) -> None:
    made = post(client, "missions", wishful(here, name="North", plan=True)).json()
    changed = patch(client, f"missions/{made['id']}", {"locks": []}).json()
    assert (changed["locks"], changed["plan"]) == ([], None)
    assert changed["last_plan"]["locks"] == 1
    assert patch(client, f"missions/{made['id']}", {"plan": True}).json()["plan"]["wish"] is None


def test_the_plan_of_a_job_is_taken_only_for_the_same_wishes(here: World, client: Client, settings: Any) -> None:
    points = [{"asset": here.line.pk, "position": [10.0 + 0.001 * number, 56.0]} for number in range(14)]
    wishes = {"locks": [{"uav": "Tern", "targets": [3, 1]}], "uavs": [TERN | {"most_targets": 14}]}
    job = Job.objects.get(pk=post(client, "plans", plan_body(*points) | wishes).json()["job"])
    plan = post(client, "plans", plan_body(*points[:2]) | wishes | {"locks": []}).json()
    Job.objects.filter(pk=job.pk).update(state=JobState.DONE, result=plan | {"routes": plan["routes"], "unassigned": []})
    body = mission_body(*points, plan=True, plan_of=str(job.pk))
    assert post(client, "missions", body | wishes).status_code == 201
    assert post(client, "missions", body | wishes | {"locks": []}).status_code == 202
    assert post(client, "missions", body | wishes | {"uavs": [TERN]}).status_code == 202


def test_a_base_that_moves_makes_a_plan_of_a_job_another_one(here: World, client: Client) -> None:
    base = Base.objects.create(name="North", location="SRID=4326;POINT(10.0205 56.0)")
    points = [{"asset": here.line.pk, "position": [10.0 + 0.001 * number, 56.0]} for number in range(14)]
    wishes = {"uavs": [TERN | {"end_action": "base"}]}
    job = Job.objects.get(pk=post(client, "plans", plan_body(*points) | wishes).json()["job"])
    assert job.parameters["request"]["bases"] == [{"name": "North", "position": [10.0205, 56.0]}]
    small = post(client, "plans", plan_body(*points[:2]) | wishes).json()
    Job.objects.filter(pk=job.pk).update(state=JobState.DONE, result=small)
    body = mission_body(*points, plan=True, plan_of=str(job.pk)) | wishes
    assert post(client, "missions", body).status_code == 201
    Base.objects.filter(pk=base.pk).update(location="SRID=4326;POINT(9.999 56.0)")
    assert post(client, "missions", body).status_code == 202


def test_a_mission_without_its_base_says_so_when_it_is_planned(here: World, client: Client) -> None:
    base = Base.objects.create(name="North", location="SRID=4326;POINT(10.0205 56.0)")
    made = post(client, "missions", mission_body(here.towers[0], uavs=[TERN | {"end_action": "base"}])).json()
    base.delete()
    assert faults(post(client, f"missions/{made['id']}/plan")) == ["uavs.0.end_action"]


def test_a_mission_knows_the_base_at_which_a_route_lands(here: World, client: Client) -> None:
    Base.objects.create(name="North", location="SRID=4326;POINT(10.0205 56.0)")
    made = post(client, "missions", mission_body(here.towers[0], uavs=[TERN | {"end_action": "base"}], plan=True)).json()
    copy = post(client, f"missions/{made['id']}/duplicate").json()
    assert [mission["plan"]["routes"][0]["base"] for mission in (made, copy)] == ["North", "North"]
    other = post(client, "missions", mission_body(here.towers[0], plan=True)).json()
    assert other["plan"]["routes"][0]["base"] is None


@pytest.mark.parametrize("is_moved", [True, False], ids=["moved", "deleted"])
def test_a_base_that_is_gone_makes_the_missions_stale_that_land_at_it(here: World, client: Client, *, is_moved: bool) -> None:
    base = Base.objects.create(name="North", location="SRID=4326;POINT(10.0205 56.0)")
    landing = post(client, "missions", mission_body(here.towers[0], uavs=[TERN | {"end_action": "base"}], plan=True)).json()
    post(client, "missions", mission_body(here.towers[0], plan=True) | {"name": "Hovers"})

    def stale_ones() -> list[str]:
        listed = client.get("/api/v1/missions").json()["results"]
        filtered = client.get("/api/v1/missions?stale=true").json()["results"]
        assert [row["name"] for row in listed if row["is_stale"]] == [row["name"] for row in filtered]
        return [row["name"] for row in filtered]

    assert stale_ones() == []
    Base.objects.filter(pk=base.pk).update(name="Northern", location="SRID=4326;POINT(10.0205 56.0)")
    assert stale_ones() == []  # only its name is another one
    if is_moved:
        Base.objects.filter(pk=base.pk).update(location="SRID=4326;POINT(9.999 56.0)")
    else:
        base.delete()
    assert stale_ones() == [landing["name"]]
    now = client.get(f"/api/v1/missions/{landing['id']}").json()
    assert now["stale_reason"] == "A base changed since this was planned. Tern is to land at North, which is no longer there."
    assert [(cause["what"], cause["uav"]) for cause in now["stale_causes"]] == [("base", 0)]


def test_a_target_that_is_left_out_is_stored_with_its_reason(here: World, client: Client) -> None:
    post(client, "missions", mission_body({"asset": here.towers[0].pk, "sensor": "Lidar"}, here.towers[1], plan=True))
    row = InspectionTarget.objects.get(sequence=0)
    assert (row.unassigned_reason, row.unassigned_message) == ("not_allowed", "No UAV of the plan has the sensor Lidar.")


def test_why_a_target_is_not_reached_names_its_wish(here: World, client: Client) -> None:
    body = plan_body({"asset": here.towers[0].pk, "sensor": "Lidar"})
    spare = {"name": "Kite", "position": list(UAV_AT), "sensor": "LIDAR", "type": unlimited_type(client)}
    post(client, "uavs", spare)
    stated = post(client, "plans/why-target", body | {"target": 0}).json()
    assert (stated["reason"], stated["sensor"], stated["tied_to"]) == ("not_allowed", "Lidar", None)
    assert [(uav["name"], uav["is_allowed"], uav["is_enough"]) for uav in stated["uavs"]] == [("Tern", False, False), ("Kite", True, True)]


def test_why_a_route_counts_the_way_to_the_base(here: World, client: Client) -> None:
    Base.objects.create(name="North", location="SRID=4326;POINT(10.0205 56.0)")
    body = plan_body(here.towers[0], here.towers[2], uavs=[TERN | {"end_action": "base"}])
    plan = post(client, "plans", body).json()
    stated = post(client, "plans/why-route", body | {"routes": [plan["routes"][0]["targets"]], "uav": 0}).json()
    assert stated["length_m"] == pytest.approx(plan["routes"][0]["length_m"], rel=1e-5)
