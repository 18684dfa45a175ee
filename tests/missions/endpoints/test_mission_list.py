"""The list of missions: found by the server, sorted by each column, paged; copies, several at once, who is there."""

from datetime import timedelta
from typing import Any

import pytest
from django.core.cache import cache
from django.test import Client
from django.utils import timezone

from inspection.services import mark_ground_changed
from missions.models import Mission, MissionState, MissionUav, Route, Waypoint
from missions.presence import MAX_PAGES
from missions.selectors.missions import mission_of_organisation
from missions.services import duplicate_mission
from tests.accounts.users import a_user, client_of
from tests.inspection.ground import line
from tests.missions.api import TERN, mission_body, patch, plan_body, post
from tests.missions.worlds import UAV_AT, World, zone_around
from workspace.models import Job, JobState, Organisation, Role, User

pytestmark = pytest.mark.django_db


@pytest.fixture(autouse=True)
def empty_cache() -> None:
    cache.clear()


def named(role: Role, name: str) -> User:
    user = a_user(role)
    user.username = name
    user.save()
    return user


@pytest.fixture
def opal() -> User:
    return named(Role.OPERATOR, "opal")


@pytest.fixture
def client(opal: User) -> Client:
    return client_of(opal)


def created(client: Client, here: World, name: str, *targets: Any, plan: bool = True, **more: Any) -> dict[str, Any]:
    response = post(client, "missions", mission_body(*(targets or [here.towers[2]]), name=name, plan=plan) | more)
    assert response.status_code == 201, response.content
    return response.json()


def names(client: Client, query: str = "") -> list[str]:
    response = client.get(f"/api/v1/missions?{query}")
    assert response.status_code == 200, response.content
    return [row["name"] for row in response.json()["results"]]


def test_a_mission_is_found_by_the_name_of_one_of_its_targets(here: World, client: Client) -> None:
    here.bridge.name = "Livingston Avenue"
    here.bridge.save()
    created(client, here, "North", here.bridge, plan=False)
    created(client, here, "South", plan=False)
    assert names(client, "text=livingston") == ["North"]
    assert names(client, "text=south") == ["South"]


def test_filters_leave_what_they_say(here: World, client: Client) -> None:
    uav = post(client, "uavs", {"name": "Kite", "position": list(UAV_AT)}).json()["id"]
    created(client, here, "By Kite", uavs=[{"id": uav}])
    created(client, here, "Draft", plan=False)
    rory = client_of(named(Role.OPERATOR, "rory"))
    created(rory, here, "Rory's")
    Mission.objects.filter(name="Rory's").update(state=MissionState.APPROVED)
    assert names(client, f"uav={uav}") == ["By Kite"]
    assert names(client, "author=rory") == ["Rory's"]
    assert sorted(names(client, "state=draft,approved")) == ["Draft", "Rory's"]
    assert client.get("/api/v1/missions/filters").json() == {
        "authors": [{"name": "opal", "missions": 2}, {"name": "rory", "missions": 1}],
        "uavs": [{"id": uav, "name": "Kite", "missions": 1}],
    }


def test_stale_missions_are_those_planned_on_an_older_ground(here: World, client: Client) -> None:
    created(client, here, "Old")
    created(client, here, "Draft", plan=False)
    mark_ground_changed()
    assert names(client, "stale=true") == ["Old"]
    assert names(client, "stale=false") == ["Draft"]


def test_missions_are_found_by_when_they_were_changed(here: World, client: Client) -> None:
    created(client, here, "Now", plan=False)
    created(client, here, "Then", plan=False)
    then = Mission.objects.get(name="Then")
    Mission.objects.filter(pk=then.pk).update(updated_at=then.updated_at - timedelta(days=10))
    since = (then.updated_at - timedelta(days=1)).date()
    assert names(client, f"changed_from={since}") == ["Now"]
    assert names(client, f"changed_before={since}") == ["Then"]


@pytest.mark.parametrize("fault", ["order=colour", "state=lost", "uav=kite", "changed_from=soon", "changed_before=2026-13-40"])
def test_what_no_list_can_be_asked_for_is_refused(client: Client, fault: str) -> None:
    response = client.get(f"/api/v1/missions?{fault}")
    assert (response.status_code, response.json()["error"]["code"]) == (400, "invalid")


@pytest.mark.parametrize("column", ["name", "author", "state", "targets", "uavs", "distance", "time", "changed"])
def test_each_column_sorts_both_ways_and_pages_without_gap_or_repeat(here: World, client: Client, column: str) -> None:
    created(client, here, "alder", here.towers[5], here.towers[1])
    created(client, here, "Birch", plan=False)
    created(client, here, "cedar", here.towers[1])
    created(client, here, "Dogwood", plan=False, uavs=[])
    up, down = names(client, f"order={column}"), names(client, f"order=-{column}")
    assert up == down[::-1]
    paged, next_page = [], f"/api/v1/missions?order={column}&limit=1"
    while next_page and len(paged) < 8:
        answer = client.get(next_page).json()
        paged += [row["name"] for row in answer["results"]]
        next_page = answer["next"]
    assert paged == up
    if column == "name":
        assert up == ["alder", "Birch", "cedar", "Dogwood"]
    if column == "distance":
        assert up[-1] == "alder"
        assert set(up[:2]) == {"Birch", "Dogwood"}


def test_the_list_counts_a_later_take_off_in_a_missions_time(here: World, client: Client) -> None:
    created(client, here, "Late", here.towers[1])
    Route.objects.update(departs_s=120.0)
    (mission,) = client.get("/api/v1/missions").json()["results"]
    assert mission["duration_s"] == pytest.approx(120.0 + Route.objects.get().duration_s)


def test_the_list_says_how_many_there_are_in_all_and_in_each_state(here: World, client: Client) -> None:
    created(client, here, "A")
    created(client, here, "B", plan=False)
    created(client, here, "C", plan=False)
    answer = client.get("/api/v1/missions?state=draft&limit=1").json()
    assert (answer["total"], answer["by_state"]) == (2, {"draft": 2, "planned": 1})


def test_the_list_says_how_many_deleted_missions_it_leaves_out(here: World, client: Client) -> None:
    for name in ("Alder", "Birch", "Cedar"):
        created(client, here, name, plan=False)
    assert client.get("/api/v1/missions").json()["deleted_count"] == 0
    Mission.objects.exclude(name="Cedar").update(deleted_at=timezone.now())
    answer = client.get("/api/v1/missions?state=planned").json()
    assert (answer["total"], answer["deleted_count"]) == (0, 2)
    assert client.get("/api/v1/missions?text=bir").json()["deleted_count"] == 1
    assert client.get("/api/v1/missions?deleted=true").json()["deleted_count"] == 2


def test_the_drawing_shows_lines_round_the_routes_and_places_of_a_draft(here: World, client: Client) -> None:
    created(client, here, "Draft", here.towers[0], {"position": [10.008, 56.012]}, plan=False)
    [row] = client.get("/api/v1/missions").json()["results"]
    assert row["sketch"] == []
    assert row["places"] == [[10.0, 56.0], [10.008, 56.012]]
    assert len(row["lines"]) == 2  # the power line and the railway
    assert all(9.9 < lon < 10.1 and 55.9 < lat < 56.1 for line in row["lines"] for lon, lat in line)


def test_the_drawing_of_a_wide_mission_is_no_finer_than_it_is_seen(here: World, client: Client) -> None:
    winding = line(*[(10.0 + 0.001 * step, 56.0 + 0.002 * (step % 2)) for step in range(2_000)])
    created(client, here, "Wide", {"position": [10.0, 56.0]}, {"position": [12.0, 56.0]}, plan=False)
    drawn = client.get("/api/v1/missions").json()["results"][0]["lines"]
    assert winding.geometry.num_points == 2_000
    assert sum(map(len, drawn)) < 100


def test_a_list_seen_again_asks_for_no_drawing_again(here: World, client: Client, django_assert_max_num_queries: Any) -> None:
    for number in range(4):
        created(client, here, f"M{number}", plan=False)
    client.get("/api/v1/missions")
    with django_assert_max_num_queries(9):
        client.get("/api/v1/missions")


def test_a_copy_has_the_plan_and_a_name_of_its_own(here: World, client: Client) -> None:
    mission = created(client, here, "North", here.towers[2], here.line)
    first = post(client, f"missions/{mission['id']}/duplicate")
    assert first.status_code == 201
    copy = first.json()
    assert (copy["name"], copy["state"], copy["revision"]) == ("North (copy)", "planned", 1)
    assert copy["plan"] == mission["plan"]
    assert copy["id"] != mission["id"]
    assert (Route.objects.count(), MissionUav.objects.count()) == (2, 2)
    assert Waypoint.objects.filter(route__mission=copy["id"]).exclude(target=None).exclude(target__mission=copy["id"]).count() == 0
    assert post(client, f"missions/{mission['id']}/duplicate").json()["name"] == "North (copy 2)"
    assert post(client, f"missions/{mission['id']}/duplicate", {"name": "South"}).json()["name"] == "South"


def test_a_copy_of_a_mission_that_was_flown_is_planned_and_pending(here: World, client: Client) -> None:
    mission = created(client, here, "Flown")
    Mission.objects.update(state=MissionState.COMPLETED)
    Mission.objects.get().targets.update(state="complete")
    copy = post(client, f"missions/{mission['id']}/duplicate").json()
    assert (copy["state"], copy["targets"][0]["state"]) == ("planned", "pending")


def test_a_copy_is_of_the_mission_as_it_is_when_it_is_copied(here: World, client: Client, opal: User) -> None:
    mission = created(client, here, "North", here.towers[2])
    read_before = mission_of_organisation(opal.organisation, mission["id"])
    changed = patch(client, f"missions/{mission['id']}", {"uavs": [TERN, TERN | {"name": "Gull"}], "plan": True}).json()
    copy = duplicate_mission(mission=read_before, author=opal)
    assert client.get(f"/api/v1/missions/{copy.pk}").json()["plan"] == changed["plan"]


def test_several_are_deleted_at_once_and_brought_back(here: World, client: Client) -> None:
    one, two, frozen = [created(client, here, name, plan=False)["id"] for name in ("One", "Two", "Frozen")]
    Mission.objects.filter(pk=frozen).update(state=MissionState.ACTIVE, planned_at="2026-01-01T00:00Z", graph_version=1)
    elsewhere = "00000000-0000-4000-8000-000000000000"
    answer = post(client, "missions/delete", {"missions": [one, two, frozen, elsewhere]}).json()
    assert answer["done"] == [one, two]
    assert [(row["id"], row["code"]) for row in answer["refused"]] == [(frozen, "mission_frozen"), (elsewhere, "not_found")]
    assert names(client) == ["Frozen"]
    assert sorted(names(client, "deleted=true")) == ["One", "Two"]
    assert post(client, "missions/restore", {"missions": [one, two]}).json()["done"] == [one, two]
    assert sorted(names(client)) == ["Frozen", "One", "Two"]


def test_a_strangers_mission_is_not_deleted_with_ones_own(here: World, client: Client) -> None:
    mission = created(client, here, "Mine", plan=False)["id"]
    stranger = client_of(a_user(organisation=Organisation.objects.create(name="Elsewhere")))
    answer = post(stranger, "missions/delete", {"missions": [mission]}).json()
    assert (answer["done"], answer["refused"][0]["code"]) == ([], "not_found")
    assert names(client) == ["Mine"]


def test_a_mission_that_is_as_it_was_is_not_sent_again(here: World, client: Client, django_assert_num_queries: Any) -> None:
    mission = created(client, here, "Watched")
    path, etag = f"/api/v1/missions/{mission['id']}", f'"{mission["revision"]}"'
    with django_assert_num_queries(3):  # session, user, one column of one mission
        same = client.get(path, headers={"If-None-Match": etag})
    assert (same.status_code, same.content, same["ETag"]) == (304, b"", etag)
    patch(client, f"missions/{mission['id']}", {"name": "Changed"})
    changed = client.get(path, headers={"If-None-Match": etag})
    assert (changed.status_code, changed.json()["name"]) == (200, "Changed")
    client.delete(path, headers={"If-Match": "*"})
    assert client.get(path, headers={"If-None-Match": changed["ETag"]}).status_code == 404


def test_no_browser_keeps_a_mission_to_take_its_old_ground_for_the_new_one(here: World, client: Client) -> None:
    answer = client.get(f"/api/v1/missions/{created(client, here, 'Watched')['id']}")
    assert answer["Cache-Control"] == "no-store"


def test_pages_hear_of_each_other_until_they_leave(here: World, client: Client, opal: User) -> None:
    path = f"missions/{created(client, here, 'Shared', plan=False)['id']}/presence"
    vera = client_of(named(Role.VIEWER, "vera"))
    assert post(client, path, {"editor": "one"}).json()["others"] == []
    assert post(vera, path, {"editor": "two"}).json()["others"] == [{"name": "opal", "is_me": False, "is_planning": False}]
    assert [(other["name"], other["is_me"]) for other in post(client, path, {"editor": "three"}).json()["others"]] == [
        ("vera", False), ("opal", True),
    ]  # fmt: skip
    post(vera, path, {"editor": "two", "here": False})
    post(client, path, {"editor": "three", "here": False})
    assert post(client, path, {"editor": "one"}).json()["others"] == []
    stranger = client_of(a_user(organisation=Organisation.objects.create(name="Elsewhere")))
    assert post(stranger, path, {"editor": "one"}).status_code == 404


def test_pages_of_one_mission_see_that_another_one_plans_it(here: World, client: Client) -> None:
    path = f"missions/{created(client, here, 'Shared', plan=False)['id']}/presence"
    vera = client_of(named(Role.VIEWER, "vera"))

    def seen(person: Client) -> list[tuple[str, bool]]:
        return [(other["name"], other["is_planning"]) for other in post(person, path, {"editor": "looks"}).json()["others"]]

    post(client, path, {"editor": "plans", "planning": True})
    post(client, path, {"editor": "idle"})
    assert seen(vera) == [("opal", True)]
    assert seen(client) == [("vera", False), ("opal", True)]
    post(client, path, {"editor": "plans"})
    assert seen(vera) == [("opal", False)]


def test_a_stale_mission_names_zone_leg_and_place(here: World, client: Client) -> None:
    mission = created(client, here, "Stale", here.towers[1], here.towers[5])
    zone_around((10.012, 56.0), name="Fire brigade")
    stale = client.get(f"/api/v1/missions/{mission['id']}").json()
    [cause] = stale["stale_causes"]
    assert (cause["what"], cause["uav"], cause["leg"]) == ("zone", 0, ["A1", "A2"])
    assert cause["message"] == "Fire brigade touches the leg from A1 to A2 of Tern. It is flown 60 m above ground."
    assert (cause["agl_m"], cause["from"], cause["to"]) == ([60.0, 60.0], None, None)
    assert cause["position"] == pytest.approx([10.012, 56.0], abs=0.005)
    assert stale["stale_reason"] == f"A zone changed since this was planned. {cause['message']}"


def job_of(opal: User, plan: dict[str, Any], request: dict[str, Any]) -> Job:
    return Job.objects.create(
        organisation=opal.organisation, created_by=opal, task="missions.tasks.solve_plan", state=JobState.DONE,
        parameters={"request": request}, result=plan,
    )  # fmt: skip


def asked(*targets: int) -> dict[str, Any]:
    uav = {"name": "Tern", "position": list(UAV_AT), "max_range_m": None, "cruise_speed_mps": 12.0, "end_action": "hover", "uav": None}
    rows = [{"asset": target, "position": None, "stretch": None, "task": None} for target in targets]
    return {"uavs": [uav], "targets": rows, "objective": "total", "return_to_start": False}


def test_the_plan_that_was_seen_is_the_plan_that_is_stored(here: World, client: Client, opal: User) -> None:
    tower = here.towers[2]
    plan = post(client, "plans", plan_body(tower)).json()
    seen = plan | {"total_length_m": 4321.0}  # a long search may find another one the next time
    job = job_of(opal, seen, asked(tower.pk))
    mission = created(client, here, "Seen", tower, plan_of=str(job.pk))
    assert mission["plan"]["total_length_m"] == 4321.0
    other = created(client, here, "Other", here.towers[4], plan_of=str(job.pk))
    assert other["plan"]["total_length_m"] != 4321.0  # it was asked for something else: planned anew


def test_the_history_names_what_came_and_went(here: World, client: Client) -> None:
    mission = created(client, here, "North", here.towers[2], here.line, plan=False)
    patch(client, f"missions/{mission['id']}", {"targets": [{"asset": here.line.pk}], "uavs": [TERN, TERN | {"name": "Kite"}]})
    entry = client.get(f"/api/v1/missions/{mission['id']}/history").json()["results"][0]["after"]
    assert (entry["targets"], entry["targets_added"], entry["targets_removed"]) == (1, 0, 1)
    assert entry["targets_names"] == {"added": [], "removed": [mission["targets"][0]["label"]]}
    assert entry["uavs_names"]["added"] == ["Kite"]


def test_one_user_with_ever_new_pages_fills_no_memory(here: World, client: Client) -> None:
    mission = created(client, here, "Shared", plan=False)["id"]
    for number in range(MAX_PAGES + 3):
        post(client, f"missions/{mission}/presence", {"editor": f"page-{number}"})
    kept = cache.get(f"mission-open:{mission}")
    assert len(kept) == MAX_PAGES
    assert any(page.endswith(f"page-{MAX_PAGES + 2}") for page in kept)


def test_without_the_cache_missions_are_listed_and_nobody_is_seen(here: World, client: Client, settings: Any) -> None:
    mission = created(client, here, "North")["id"]
    settings.CACHES = {"default": {"BACKEND": "django.core.cache.backends.redis.RedisCache", "LOCATION": "unix:///nowhere/redis.sock"}}
    assert client.get("/api/v1/missions").json()["results"][0]["lines"] != []
    assert post(client, f"missions/{mission}/presence", {"editor": "one"}).json()["others"] == []
