"""Missions: create, plan, re-plan, list, open, change, delete, bring back; never mixed from two plans."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any
from unittest import mock
from uuid import uuid4

import pytest
from django.db import connections
from django.test import Client

from inspection.services import mark_ground_changed
from inspection.services.ground import number_supports
from missions import tasks
from missions.models import Mission, MissionState, Route, Waypoint
from missions.services import MissionChanged, make_plan, plan_mission, request_of_mission, store_plan
from planning.energy.performance import Performance, performance_to_json
from tests.accounts.users import a_user, client_of
from tests.missions.api import TERN, mission_body, patch, plan_body, post
from tests.missions.worlds import UAV_AT, World, rebuild, world, zone_around
from workspace.models import AuditEntry, Job, Organisation, Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def here() -> World:
    return world()


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.OPERATOR))


def created(client: Client, here: World, **more: Any) -> dict[str, Any]:
    response = post(client, "missions", mission_body(here.towers[2], here.line, plan=True) | more)
    assert response.status_code == 201, response.content
    return response.json()


def test_a_mission_is_created_planned_and_found_again(here: World, client: Client) -> None:
    response = post(client, "missions", mission_body(here.towers[2], here.line, {"position": [10.0, 56.3]}, plan=True))
    assert response.status_code == 201
    mission = response.json()
    assert response["Location"] == f"/api/v1/missions/{mission['id']}"
    assert response["ETag"] == f'"{mission["revision"]}"'
    assert client.get(response["Location"]).json() == mission
    assert (mission["name"], mission["state"], mission["is_stale"]) == ("Bexley spring", "planned", False)
    assert [target["unassigned_reason"] for target in mission["targets"]] == ["", "", "too_far_from_network"]
    assert [target["kind"] for target in mission["targets"]] == ["tower", "line", None]


def test_a_reopened_mission_names_its_targets_as_the_list_of_assets_does(client: Client, django_assert_num_queries: Any) -> None:
    here = world()
    here.line.operator = "AEP"
    here.line.save()
    number_supports()
    targets = [*here.towers, here.line, here.bridge, {"position": [10.0, 56.3]}]
    mission = post(client, "missions", mission_body(*targets)).json()
    with django_assert_num_queries(9):  # session, user and organisation, mission, UAVs, targets, routes, changed UAVs, ground, open job
        opened = client.get(f"/api/v1/missions/{mission['id']}").json()
    names = [(target["label"], target["detail"]) for target in opened["targets"]]
    assert names[:6] == [(f"Tower {place} of 6", "110 kV AEP") for place in range(1, 7)]
    for asset, name in zip([*here.towers, here.line, here.bridge], names, strict=False):
        properties = client.get(f"/api/v1/assets/{asset.pk}").json()["properties"]
        assert name == (properties["label"], properties["detail"])
    assert names[-1][1] == ""


def test_a_stored_plan_equals_the_plan_that_the_planner_answers(here: World, client: Client) -> None:
    body = plan_body(here.towers[2], here.line, {"asset": here.line.pk, "position": [10.014, 56.0]}, {"position": [10.0, 56.3]})
    answered = post(client, "plans", body).json()
    stored = post(client, "missions", body | {"name": "Same", "plan": True}).json()["plan"]
    assert stored == answered


def test_a_draft_keeps_what_was_picked_until_it_is_planned(here: World, client: Client) -> None:
    mission = created(client, here, plan=False)
    assert (mission["state"], mission["plan"], mission["planned_at"]) == ("draft", None, None)
    assert mission["targets"][1]["label"] == "110 kV"
    planned = post(client, f"missions/{mission['id']}/plan").json()
    assert planned["state"] == "planned"
    assert planned["revision"] == mission["revision"] + 1


def test_a_mission_without_targets_is_a_draft_and_cannot_be_planned(client: Client) -> None:
    mission = post(client, "missions", {"name": "Empty"}).json()
    response = post(client, f"missions/{mission['id']}/plan")
    assert (response.status_code, response.json()["error"]["code"]) == (400, "nothing_to_plan")


def test_new_targets_drop_the_plan_and_a_new_name_keeps_it(here: World, client: Client) -> None:
    mission = created(client, here)
    renamed = patch(client, f"missions/{mission['id']}", {"name": "Bexley autumn"}).json()
    assert (renamed["name"], renamed["state"], renamed["plan"]) == ("Bexley autumn", "planned", mission["plan"])
    changed = patch(client, f"missions/{mission['id']}", {"targets": [{"asset": here.towers[5].pk}]}).json()
    assert (changed["state"], changed["plan"], len(changed["targets"])) == ("draft", None, 1)
    planned = patch(client, f"missions/{mission['id']}", {"return_to_start": True, "plan": True}).json()
    assert planned["plan"]["routes"][0]["end_action"] == "return"


def test_if_match_protects_what_somebody_else_has_changed(here: World, client: Client) -> None:
    mission = created(client, here)
    path, etag = f"missions/{mission['id']}", f'"{mission["revision"]}"'
    assert patch(client, path, {"name": "Mine"}, **{"If-Match": etag}).status_code == 200
    late = patch(client, path, {"name": "Theirs"}, **{"If-Match": etag})
    assert (late.status_code, late.json()["error"]["code"]) == (412, "mission_changed")
    assert post(client, f"{path}/plan", **{"If-Match": etag}).status_code == 412
    assert client.delete(f"/api/v1/{path}", headers={"If-Match": etag}).status_code == 412
    assert client.get(f"/api/v1/{path}").json()["name"] == "Mine"


def test_an_idle_uav_keeps_its_place_in_the_sketch(here: World, client: Client) -> None:
    """Kite stands 80 km off: Tern, the second, does it all and is still drawn as the second."""
    kite = {"name": "Kite", "position": [11.0, 56.5]}
    created(client, here, uavs=[kite, TERN])
    (summary,) = client.get("/api/v1/missions").json()["results"]
    assert [len(line) > 1 for line in summary["sketch"]] == [False, True]


def test_the_list_shows_summaries_with_a_sketch_and_filters(here: World, client: Client) -> None:
    first, second = created(client, here, name="Alum creek"), created(client, here, name="Bexley", plan=False)
    listed = client.get("/api/v1/missions").json()["results"]
    assert [mission["id"] for mission in listed] == [second["id"], first["id"]]
    summary = listed[1]
    assert (summary["target_count"], summary["unassigned_count"], summary["uav_count"]) == (2, 0, 1)
    assert summary["total_length_m"] == first["plan"]["total_length_m"]
    assert summary["duration_s"] == first["plan"]["routes"][0]["duration_s"]
    assert len(summary["sketch"]) == 1
    assert len(summary["sketch"][0]) >= 2
    assert listed[0]["sketch"] == []
    assert [row["name"] for row in client.get("/api/v1/missions?text=alum").json()["results"]] == ["Alum creek"]
    assert [row["name"] for row in client.get("/api/v1/missions?state=draft").json()["results"]] == ["Bexley"]
    page = client.get("/api/v1/missions?limit=1").json()
    assert [row["name"] for row in page["results"]] == ["Bexley"]
    assert [row["name"] for row in client.get(page["next"]).json()["results"]] == ["Alum creek"]


def test_the_list_says_how_many_targets_a_plan_leaves_out(here: World, client: Client) -> None:
    post(client, "missions", mission_body(here.towers[2], here.line, {"position": [10.0, 56.3]}, plan=True))
    [summary] = client.get("/api/v1/missions").json()["results"]
    assert (summary["target_count"], summary["unassigned_count"]) == (3, 1)


def test_a_deleted_mission_is_gone_and_can_be_brought_back(here: World, client: Client) -> None:
    mission = created(client, here)
    path = f"/api/v1/missions/{mission['id']}"
    assert client.delete(path, headers={"If-Match": "*"}).status_code == 204
    assert client.get(path).status_code == 404
    assert client.get("/api/v1/missions").json()["results"] == []
    assert len(client.get("/api/v1/missions?deleted=true").json()["results"]) == 1
    restored = post(client, f"missions/{mission['id']}/restore").json()
    assert restored["plan"] == mission["plan"]
    assert client.get(path).status_code == 200


def test_the_history_says_who_did_what(here: World, client: Client) -> None:
    mission = created(client, here)
    path = f"missions/{mission['id']}"
    patch(client, path, {"name": "Renamed"})
    patch(client, path, {"objective": "makespan"})
    client.delete(f"/api/v1/{path}", headers={"If-Match": "*"})
    post(client, f"{path}/restore")
    entries = client.get(f"/api/v1/{path}/history").json()["results"]
    assert [entry["action"] for entry in entries] == ["restore", "delete", "change", "rename", "plan", "create"]
    assert {entry["actor"] for entry in entries} == {Mission.objects.get().author.username}
    assert entries[3]["before"]["name"] == "Bexley spring"
    assert entries[3]["after"]["name"] == "Renamed"


def test_missions_of_another_organisation_do_not_exist(here: World, client: Client) -> None:
    mission = created(client, here)
    stranger = client_of(a_user(organisation=Organisation.objects.create(name="Elsewhere")))
    path = f"missions/{mission['id']}"
    answers = [
        stranger.get(f"/api/v1/{path}"), patch(stranger, path, {"name": "Taken"}),
        stranger.delete(f"/api/v1/{path}", headers={"If-Match": "*"}),
        post(stranger, f"{path}/plan"), post(stranger, f"{path}/restore"), stranger.get(f"/api/v1/{path}/history"),
        stranger.get(f"/api/v1/{path}/legal-windows"),
    ]  # fmt: skip
    assert {answer.status_code for answer in answers} == {404}
    assert stranger.get("/api/v1/missions").json()["results"] == []


def test_viewers_read_missions_and_change_nothing(here: World, client: Client) -> None:
    mission = created(client, here)
    viewer = client_of(a_user(Role.VIEWER))
    path = f"missions/{mission['id']}"
    assert viewer.get(f"/api/v1/{path}").status_code == 200
    answers = [
        post(viewer, "missions", mission_body()),
        patch(viewer, path, {}),
        viewer.delete(f"/api/v1/{path}", headers={"If-Match": "*"}),
        post(viewer, f"{path}/plan"),
    ]
    assert {answer.status_code for answer in answers} == {403}


def test_a_repeated_key_creates_one_mission(here: World, client: Client) -> None:
    body = mission_body(here.towers[0], plan=True)
    answers = [post(client, "missions", body, **{"Idempotency-Key": "one"}) for _ in range(2)]
    assert [answer.status_code for answer in answers] == [201, 201]
    assert answers[0].json() == answers[1].json()
    assert Mission.objects.count() == 1


def test_bad_input_is_refused_and_nothing_is_stored(here: World, client: Client) -> None:
    assert post(client, "missions", mission_body(here.towers[0], name="")).status_code == 400
    assert post(client, "missions", mission_body({"asset": 999_999})).status_code == 400
    assert client.get(f"/api/v1/missions/{uuid4()}").status_code == 404
    assert not Mission.objects.exists()


def test_a_mission_that_cannot_be_planned_as_asked_is_not_left_behind(client: Client) -> None:
    response = post(client, "missions", mission_body({"position": list(UAV_AT)}, plan=True))
    assert (response.status_code, response.json()["error"]["code"]) == (503, "no_graph")
    assert not Mission.objects.exists()


def test_a_frozen_mission_cannot_be_changed(here: World, client: Client) -> None:
    mission = created(client, here)
    Mission.objects.update(state=MissionState.APPROVED)
    for response in (patch(client, f"missions/{mission['id']}", {"name": "No"}), post(client, f"missions/{mission['id']}/plan")):
        assert (response.status_code, response.json()["error"]["code"]) == (409, "mission_frozen")


def test_a_zone_put_over_a_route_makes_the_mission_stale_and_says_which(here: World, client: Client) -> None:
    mission = created(client, here)
    zone_around((10.008, 56.0), name="Fire brigade")
    stale = client.get(f"/api/v1/missions/{mission['id']}").json()
    assert stale["is_stale"]
    touched = "Fire brigade touches the leg from the start to A1 of Tern. It is flown 60 m above ground."
    assert stale["stale_reason"] == f"A zone changed since this was planned. {touched}"
    assert client.get("/api/v1/missions").json()["results"][0]["is_stale"]
    again = post(client, f"missions/{mission['id']}/plan").json()
    assert not again["is_stale"]
    assert again["targets"][0]["unassigned_reason"] == "inside_zone"


def test_a_change_elsewhere_is_said_to_touch_no_route(here: World, client: Client) -> None:
    mission = created(client, here)
    zone_around((10.2, 56.2))
    stale = client.get(f"/api/v1/missions/{mission['id']}").json()
    assert (stale["is_stale"], stale["stale_reason"]) == (
        True,
        "The ground has changed since this was planned. No zone in force touches the routes.",
    )


def test_a_vanished_target_makes_the_mission_stale_and_stays_a_target(here: World, client: Client) -> None:
    mission = created(client, here)
    tower = here.towers[2]
    tower.vanished_at = "2026-01-01T00:00Z"
    tower.save()
    mark_ground_changed()
    stale = client.get(f"/api/v1/missions/{mission['id']}").json()
    assert stale["stale_reason"].startswith("An asset changed since this was planned.")
    assert stale["targets"][0]["asset"] == tower.pk


def test_a_deleted_asset_leaves_the_target_with_its_label(here: World, client: Client) -> None:
    mission = created(client, here)
    here.towers[2].delete()
    rebuild()
    opened = client.get(f"/api/v1/missions/{mission['id']}").json()
    assert (opened["targets"][0]["asset"], opened["targets"][0]["label"]) == (None, mission["targets"][0]["label"])
    again = post(client, f"missions/{mission['id']}/plan").json()
    assert again["targets"][0]["unassigned_reason"] == "asset_gone"


def large_mission(here: World, client: Client) -> tuple[Mission, Job]:
    points = [{"asset": here.line.pk, "position": [10.0 + 0.001 * number, 56.0]} for number in range(13)]
    response = post(client, "missions", mission_body(*points, plan=True))
    assert response.status_code == 202
    return Mission.objects.get(pk=response.json()["mission"]), Job.objects.get(pk=response.json()["job"])


def test_a_large_mission_is_planned_by_a_job(here: World, client: Client, settings: Any) -> None:
    settings.ROUTING_RULES = replace(settings.ROUTING_RULES, large_plan_search_s=0.3)
    mission, job = large_mission(here, client)
    assert mission.state == MissionState.DRAFT
    tasks.plan_mission(str(job.pk))
    job.refresh_from_db()
    assert (job.state, job.result) == ("done", {"mission": str(mission.pk), "revision": 2})
    assert client.get(f"/api/v1/missions/{mission.pk}").json()["plan"]["unassigned"] == []


def test_a_jobs_plan_is_not_stored_on_a_mission_that_was_changed_meanwhile(here: World, client: Client, settings: Any) -> None:
    settings.ROUTING_RULES = replace(settings.ROUTING_RULES, large_plan_search_s=0.3)
    mission, job = large_mission(here, client)
    patch(client, f"missions/{mission.pk}", {"targets": [{"asset": here.towers[0].pk}]})
    tasks.plan_mission(str(job.pk))
    job.refresh_from_db()
    assert (job.state, job.error["code"]) == ("failed", "mission_changed")
    assert not Route.objects.exists()


def test_a_mission_names_the_job_that_is_planning_it(here: World, client: Client) -> None:
    mission, job = large_mission(here, client)
    address = f"/api/v1/missions/{mission.pk}"
    assert client.get(address).json()["planning_job"] == str(job.pk)
    Job.objects.filter(pk=job.pk).update(state="done")
    assert client.get(address).json()["planning_job"] is None


def test_a_stopped_job_stores_the_best_plan_until_then(here: World, client: Client, settings: Any) -> None:
    settings.ROUTING_RULES = replace(settings.ROUTING_RULES, large_plan_search_s=0.3)
    mission, job = large_mission(here, client)
    with mock.patch("workspace.jobs.job_watch.JobWatch.stop", return_value=True):
        tasks.plan_mission(str(job.pk))
    job.refresh_from_db()
    mission.refresh_from_db()
    assert (job.state, mission.state) == ("done", "planned")
    assert mission.revision == job.result["revision"]


def test_a_plan_for_an_older_revision_changes_nothing(here: World, client: Client) -> None:
    mission = Mission.objects.get(pk=created(client, here)["id"])
    before = list(Waypoint.objects.values())
    plan = make_plan(request=replace(request_of_mission(mission=mission), return_to_start=True))
    with pytest.raises(MissionChanged):
        store_plan(mission=mission, actor=None, revision=mission.revision - 1, plan=plan)
    assert list(Waypoint.objects.values()) == before


def test_a_plan_that_fails_halfway_leaves_the_old_one_whole(here: World, client: Client) -> None:
    mission = Mission.objects.get(pk=created(client, here)["id"])
    before = list(Route.objects.values()), list(Waypoint.objects.values()), AuditEntry.objects.count()
    plan = make_plan(request=request_of_mission(mission=mission))
    plan["routes"][0]["waypoints"][-1]["altitude_agl_m"] = None
    with pytest.raises(Exception, match="altitude_agl_m"):
        store_plan(mission=mission, actor=None, revision=mission.revision, plan=plan)
    assert (list(Route.objects.values()), list(Waypoint.objects.values()), AuditEntry.objects.count()) == before


@pytest.mark.django_db(transaction=True)
def test_of_plans_made_at_once_one_is_stored_whole_and_the_others_are_refused() -> None:
    here = world()
    client = client_of(a_user(Role.OPERATOR))
    mission = Mission.objects.get(pk=created(client, here, plan=False)["id"])

    def plan(_: int) -> bool:
        try:
            plan_mission(mission=mission, actor=None)
        except MissionChanged:
            return False
        finally:
            connections.close_all()
        return True

    with ThreadPoolExecutor(4) as pool:
        stored = list(pool.map(plan, range(4)))
    assert sum(stored) == 1
    mission.refresh_from_db()
    assert mission.revision == 2
    assert Route.objects.count() == 1
    assert set(Route.objects.values_list("graph_version", flat=True)) == {mission.graph_version}


def test_a_uav_at_a_mission_keeps_its_values_when_the_stored_one_moves(here: World, client: Client) -> None:
    uav = post(client, "uavs", {"name": "Tern 9", "position": list(UAV_AT), "max_range_m": 9_000}).json()["id"]
    mission = post(client, "missions", mission_body(here.towers[0]) | {"uavs": [{"id": uav}]}).json()
    patch(client, f"uavs/{uav}", {"position": [11.0, 57.0]})
    opened = client.get(f"/api/v1/missions/{mission['id']}").json()
    assert opened["uavs"] == [
        {
            "id": uav,
            "name": "Tern 9",
            "position": list(UAV_AT),
            "max_range_m": 9_000.0,
            "cruise_speed_mps": 12.0,
            "end_action": "return",
            "most_targets": None,
            "sensors": [],
            "sorties": 1,
            "is_simulated": False,
            "own_figures": [],
            **performance_to_json(Performance()),
        }
    ]
