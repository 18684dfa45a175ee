"""POST /api/v1/plans, at once and as a job."""

from dataclasses import replace
from typing import Any
from unittest import mock

import pytest
from django.db import OperationalError
from django.test import Client

from missions import tasks
from missions.models import Mission
from missions.services import NO_SHORTFALL
from planning.solver import solver
from planning.solver.search import Progress
from tests.accounts.users import a_user, client_of
from tests.missions.api import TERN, plan_body, post, unlimited_type
from tests.missions.worlds import UAV_AT, World, world
from tests.workspace.counters import forget_counts
from workspace.jobs import job_watch
from workspace.jobs.services import cancel_job
from workspace.models import Job, JobState, Organisation, Role

pytestmark = pytest.mark.django_db

LARGE = 14


@pytest.fixture
def here() -> World:
    return world()


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.OPERATOR))


@pytest.fixture(autouse=True)
def short_search(settings: Any) -> None:
    settings.ROUTING_RULES = replace(settings.ROUTING_RULES, large_plan_search_s=0.3)


def many(here: World) -> list[dict[str, Any]]:
    """More targets than are planned in a request: points along the line."""
    return [{"asset": here.line.pk, "position": [10.0 + 0.001 * number, 56.0]} for number in range(LARGE)]


def error_of(response: Any, status: int) -> dict[str, Any]:
    assert response.status_code == status, response.content
    return response.json()["error"]


def test_a_plan_has_the_promised_shape(here: World, client: Client) -> None:
    response = post(client, "plans", plan_body(here.towers[2], {"position": [10.0, 56.3]}))
    assert response.status_code == 200
    plan = response.json()
    assert {"objective", "total_length_m", "longest_route_m", "graph_version", "routes", "unassigned"} <= set(plan)
    (route,) = plan["routes"]
    assert {"uav", "length_m", "duration_s", "targets", "geometry", "waypoints"} <= set(route)
    assert (route["uav"], route["targets"]) == ("Tern", [0])
    assert route["geometry"]["type"] == "LineString"
    for waypoint in route["waypoints"]:
        assert set(waypoint) == {
            "position", "kind", "asset", "target", "task", "altitude_agl_m", "altitude_amsl_m", "altitude_relative_m",
        }  # fmt: skip
    assert plan["unassigned"] == [
        {
            "target": 1,
            "reason": "too_far_from_network",
            "message": "It is more than 10 km from the network.",
            "why": [{"code": "too_far_from_network", "params": {"reach_km": 10.0}}],
            **NO_SHORTFALL,
        }
    ]


def test_nothing_is_stored(here: World, client: Client) -> None:
    post(client, "plans", plan_body(here.towers[2]))
    assert not Mission.objects.exists()
    assert not Job.objects.exists()


def test_who_is_not_signed_in_is_asked_to(here: World) -> None:
    error_of(post(Client(), "plans", plan_body(here.towers[0])), 401)


def test_viewers_cannot_plan(here: World) -> None:
    error_of(post(client_of(a_user(Role.VIEWER)), "plans", plan_body(here.towers[0])), 403)


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"uavs": []}, "uavs"),
        ({"targets": []}, "targets"),
        ({"objective": "fastest"}, "objective"),
        ({"uavs": [{"name": "Tern"}]}, "uavs.0.position"),
        ({"uavs": [{"position": [10, 56]}]}, "uavs.0.name"),
        ({"uavs": [TERN | {"position": [56.0, 100.0]}]}, "uavs.0.position"),
        ({"uavs": [TERN | {"position": [10.0, "56"]}]}, "uavs.0.position"),
        ({"uavs": [TERN | {"position": [10.0, True]}]}, "uavs.0.position"),
        ({"uavs": [TERN | {"max_range_m": 0}]}, "uavs.0.max_range_m"),
        ({"uavs": [TERN | {"max_range_m": "inf"}]}, "uavs.0.max_range_m"),
        ({"uavs": [TERN | {"cruise_speed_mps": -1}]}, "uavs.0.cruise_speed_mps"),
        ({"uavs": [TERN | {"end_action": "dive"}]}, "uavs.0.end_action"),
        ({"uavs": [{"id": 123_456}]}, "uavs.0.id"),
        ({"targets": [{}]}, "targets.0.asset"),
        ({"targets": [{"asset": 999_999_999}]}, "targets.0.asset"),
        ({"targets": [{"asset": 2**70}]}, "targets.0.asset"),
        ({"targets": [{"position": [10, 56], "task": {"kind": "dance"}}]}, "targets.0.task.kind"),
        ({"targets": [{"position": [10, 56], "task": {"kind": "hold", "hold_s": 1e9}}]}, "targets.0.task.hold_s"),
        ({"targets": [{"position": [10, 56], "stretch": [[10, 56], [11, 56]]}]}, "targets.0.stretch"),
    ],
)
def test_bad_input_is_refused_with_its_place(here: World, client: Client, change: dict[str, Any], place: str) -> None:
    error = error_of(post(client, "plans", plan_body(here.towers[0]) | change), 400)
    assert error["code"] == "invalid"
    assert place in error["details"]


def test_every_fault_is_named_at_once(here: World, client: Client) -> None:
    error = error_of(post(client, "plans", plan_body({}, {"position": [200, 0]}, objective="x") | {"uavs": [{"name": "A"}]}), 400)
    assert set(error["details"]) == {"uavs.0.position", "targets.0.asset", "targets.1.position", "objective"}


def test_too_many_targets_or_uavs_are_refused(here: World, client: Client, settings: Any) -> None:
    limits = settings.ROUTING_RULES
    error = error_of(post(client, "plans", plan_body(*[{"position": [10, 56]}] * (limits.max_targets + 1))), 400)
    assert error["details"]["targets"] == [f"At most {limits.max_targets} targets; these are {limits.max_targets + 1}."]
    error = error_of(post(client, "plans", plan_body(here.towers[0]) | {"uavs": [TERN] * (limits.max_uavs + 1)}), 400)
    assert error["details"]["uavs"] == [f"At most {limits.max_uavs} UAVs; these are {limits.max_uavs + 1}."]


def test_without_a_graph_the_answer_is_try_again(client: Client) -> None:
    response = post(client, "plans", plan_body({"position": list(UAV_AT)}))
    assert error_of(response, 503)["code"] == "no_graph"
    assert int(response["Retry-After"]) > 0


def test_while_the_zones_never_rest_the_answer_is_to_try_again(here: World, client: Client) -> None:
    with mock.patch("missions.services.planning.planner.MAX_CONTEXTS", 0):
        response = post(client, "plans", plan_body(here.towers[5]))
    assert error_of(response, 503)["code"] == "graph_outdated"
    assert int(response["Retry-After"]) > 0


def test_the_rate_of_plans_is_limited_per_user(here: World, client: Client, settings: Any) -> None:
    forget_counts()
    with mock.patch("workspace.api.throttling.ScopedRate.THROTTLE_RATES", {"plans": "3/hour"}):
        answers = [post(client, "plans", plan_body(here.towers[0])).status_code for _ in range(4)]
        other = post(client_of(a_user()), "plans", plan_body(here.towers[0])).status_code
    assert answers == [200, 200, 200, 429]
    assert other == 200


def test_a_large_plan_becomes_a_job_that_ends_with_the_plan(here: World, client: Client, django_capture_on_commit_callbacks: Any) -> None:
    with mock.patch("workspace.tasks.current_app.send_task") as send, django_capture_on_commit_callbacks(execute=True):
        response = post(client, "plans", plan_body(*many(here)))
    assert response.status_code == 202
    job = Job.objects.get(pk=response.json()["job"])
    assert response["Location"] == f"/api/v1/jobs/{job.pk}"
    assert job.message == f"Planning {LARGE} targets"
    send.assert_called_once_with("missions.tasks.solve_plan", args=[str(job.pk)], retry=False)

    tasks.solve_plan(str(job.pk))
    answer = client.get(response["Location"]).json()
    assert (answer["state"], answer["progress"]) == ("done", 1.0)
    assert sorted(answer["result"]["routes"][0]["targets"]) == list(range(LARGE))


def test_a_large_plan_with_an_unknown_asset_is_refused_before_it_becomes_a_job(here: World, client: Client) -> None:
    error_of(post(client, "plans", plan_body(*many(here), {"asset": 999_999})), 400)
    assert not Job.objects.exists()


def large_job(here: World, client: Client, **more: Any) -> Job:
    return Job.objects.get(pk=post(client, "plans", plan_body(*many(here), **more)).json()["job"])


@pytest.mark.parametrize("locks", [[], [{"uav": "Tern", "targets": [5, 2]}]], ids=["free", "locked"])
def test_a_job_stopped_while_it_runs_ends_before_its_time_with_the_best_plan_until_then(
    here: World, client: Client, settings: Any, locks: list[Any]
) -> None:
    settings.ROUTING_RULES = replace(settings.ROUTING_RULES, large_plan_search_s=60.0)
    job = large_job(here, client, locks=locks)
    reported: list[float] = []

    def report(*, job: Job, progress: float, **more: Any) -> None:
        reported.append(progress)
        if len(reported) == 3:
            cancel_job(job=job)
        original(job=job, progress=progress, **more)

    original = job_watch.report_progress
    with mock.patch("workspace.jobs.job_watch.report_progress", report), mock.patch("missions.tasks.JobWatch", watching_often):
        tasks.solve_plan(str(job.pk))
    job.refresh_from_db()
    assert (job.state, job.message) == (JobState.DONE, "Stopped; the best plan until then is kept")
    assert sorted(job.result["routes"][0]["targets"]) == list(range(LARGE))
    assert (job.finished_at - job.started_at).total_seconds() < 30.0  # of a search of 60 s
    assert job.result["routes"][0]["locked"] == [target for lock in locks for target in lock["targets"]]
    assert (job.result["wish"] is not None) == bool(locks)


def test_a_job_cancelled_before_it_starts_is_never_solved(here: World, client: Client) -> None:
    job = large_job(here, client)
    cancel_job(job=job)
    with mock.patch.object(solver, "searched_plan") as search:
        tasks.solve_plan(str(job.pk))
    search.assert_not_called()


def test_a_finished_job_is_not_solved_again(here: World, client: Client) -> None:
    job = large_job(here, client)
    Job.objects.filter(pk=job.pk).update(state=JobState.DONE, result={"kept": True})
    tasks.solve_plan(str(job.pk))
    job.refresh_from_db()
    assert job.result == {"kept": True}


def test_a_job_that_fails_says_why(here: World, client: Client) -> None:
    job = large_job(here, client)
    with mock.patch("missions.services.planning.planner.MAX_CONTEXTS", 0):
        tasks.solve_plan(str(job.pk))
    job.refresh_from_db()
    assert job.state == JobState.FAILED
    assert job.error["code"] == "graph_outdated"


def test_uavs_of_another_organisation_cannot_be_used(here: World) -> None:
    other = client_of(a_user(organisation=Organisation.objects.create(name="Elsewhere")))
    own = client_of(a_user())
    uav = post(own, "uavs", {"name": "Tern 1", "position": list(UAV_AT), "max_range_m": 900.0}).json()["id"]
    assert post(own, "plans", plan_body(here.towers[0]) | {"uavs": [{"id": uav}]}).status_code == 200
    assert "uavs.0.id" in error_of(post(other, "plans", plan_body(here.towers[0]) | {"uavs": [{"id": uav}]}), 400)["details"]


def test_a_stored_uav_brings_its_values_and_the_request_overrides_them(here: World, client: Client) -> None:
    tern = {"name": "Tern 2", "position": list(UAV_AT), "max_range_m": 100.0, "type": unlimited_type(client)}
    uav = post(client, "uavs", tern).json()["id"]
    limited = post(client, "plans", plan_body(here.towers[0]) | {"uavs": [{"id": uav}]}).json()
    free = post(client, "plans", plan_body(here.towers[0]) | {"uavs": [{"id": uav, "max_range_m": None}]}).json()
    assert (limited["routes"][0]["uav"], limited["routes"][0]["uav_id"]) == ("Tern 2", uav)
    assert [item["reason"] for item in limited["unassigned"]] == ["beyond_range"]
    assert free["unassigned"] == []


def test_a_planner_whose_database_is_away_for_a_moment_goes_on(here: World, client: Client) -> None:
    job = large_job(here, client)
    away = mock.Mock(side_effect=[OperationalError("the server closed the connection"), None])
    with mock.patch("workspace.jobs.job_watch.report_progress", away), job_watch.JobWatch(job, interval_s=0.0) as watch:
        watch.note(0.5, "half way")
        watch.note(0.6, "on the way again")
        assert watch.is_cancelled is False
    assert away.call_count == 2


def test_a_database_that_is_away_leaves_the_job_for_the_next_worker(here: World, client: Client) -> None:
    job = large_job(here, client)
    with mock.patch("missions.services.make_plan", side_effect=OperationalError("gone")), pytest.raises(OperationalError):
        tasks.solve_plan(str(job.pk))
    job.refresh_from_db()
    assert job.state == JobState.RUNNING  # until its lease runs out


def test_the_best_route_so_far_is_drawn_while_it_is_searched_for(here: World, client: Client) -> None:
    job = large_job(here, client)
    drawn = []

    def report(*, best: Any = None, **more: Any) -> None:
        drawn.append(best)

    def solve(problem: Any, *, on_progress: Any, **more: Any) -> Any:
        order = tuple(range(len(problem.visits)))
        on_progress(Progress(0.5, "half way", (order,), bound=100.0))
        return original(problem, on_progress=on_progress, **more)

    original = solver.solve
    with (
        mock.patch("workspace.jobs.job_watch.report_progress", report),
        mock.patch("missions.tasks.JobWatch", watching_often),
        mock.patch("planning.assignment.assignment.solve", solve),
    ):
        tasks.solve_plan(str(job.pk))
    best = next(entry for entry in drawn if entry)
    assert (best["unit"], best["bound"], best["left_out"]) == ("m", 100.0, 0)
    assert best["value"] > 0
    (feature,) = best["routes"]["features"]
    assert (feature["properties"], feature["geometry"]["type"]) == ({"uav": 0, "targets": LARGE}, "LineString")
    assert feature["geometry"]["coordinates"][0] == pytest.approx(list(UAV_AT))


def watching_often(job: Job) -> job_watch.JobWatch:
    return job_watch.JobWatch(job, interval_s=0.02)
