"""Proofs of stored plans in the background: what they store, what they offer, and what they leave alone."""

import re
from dataclasses import replace
from typing import Any
from unittest import mock
from uuid import uuid4

import pytest
from django.test import Client

from config.private_servers import PROJECT_DIR
from missions import proof_tasks, tasks
from missions.models import Mission
from missions.services.mission_plans import PROOF_TASK, plannable_request
from missions.services.plan_proofs import MAX_OPEN_PROOFS, proven_quality
from missions.services.planning.planner import make_plan
from planning.request import request_from_json
from planning.solver.solver import MAX_PROVEN_TARGETS, Proof
from scripts import commands
from tests.accounts.users import a_user, client_of
from tests.missions.api import mission_body, patch, post
from tests.missions.worlds import World, world
from workspace.jobs.services import cancel_job
from workspace.models import Job, Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def here() -> World:
    return world()


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.OPERATOR))


@pytest.fixture(autouse=True)
def short_search(settings: Any) -> None:
    settings.ROUTING_RULES = replace(settings.ROUTING_RULES, large_plan_search_s=0.2)


def planned(here: World, client: Client, *, targets: int = 14, is_proven: bool = False) -> Mission:
    """A mission of so many places beside a line, planned; its bound is half of what it was, unless it is to be proven."""
    points = [
        {"asset": here.line.pk, "position": [10.0 + 0.001 * (number % 20), 56.0 + 0.0002 * (number // 20)]} for number in range(targets)
    ]
    answer = post(client, "missions", mission_body(*points, plan=True)).json()
    if "job" in answer:
        tasks.plan_mission(answer["job"])
    mission = Mission.objects.get(pk=answer.get("mission", answer.get("id")))
    if not is_proven and mission.plan_quality:
        bound_m = (mission.total_length_m or 0.0) / 2.0
        mission.plan_quality |= {"is_proven": False, "lower_bound_m": bound_m, "gap": 0.5, "method": "ruin and recreate"}
        mission.save(update_fields=["plan_quality"])
    return mission


def asked(client: Client, mission: Mission) -> Any:
    return post(client, f"missions/{mission.pk}/proof")


def proof_of(client: Client, mission: Mission) -> Job:
    answer = asked(client, mission)
    assert answer.status_code == 202
    return Job.objects.get(pk=answer.json()["job"])


def test_a_proof_stores_the_better_bound_and_changes_nothing_else(here: World, client: Client) -> None:
    mission = planned(here, client)
    job = proof_of(client, mission)
    assert (job.task, job.created_by) == (PROOF_TASK, None)
    proof_tasks.prove_mission(str(job.pk))
    job.refresh_from_db()
    assert job.state == "done"
    shown = client.get(f"/api/v1/missions/{mission.pk}").json()
    assert (shown["plan"]["is_proven"], shown["plan"]["gap"], shown["plan"]["proof"]) == (True, 0.0, str(job.pk))
    assert shown["plan"]["lower_bound_m"] == pytest.approx(mission.total_length_m, rel=1e-5)
    assert shown["revision"] == mission.revision
    assert job.result["total_length_m"] == pytest.approx(mission.total_length_m, rel=1e-5)


def test_a_plan_has_one_proof_until_that_fails_or_is_cancelled(here: World, client: Client) -> None:
    mission = planned(here, client)
    job = proof_of(client, mission)
    assert proof_of(client, mission).pk == job.pk
    cancel_job(job=job)
    assert proof_of(client, mission).pk != job.pk


def test_a_better_plan_is_chosen_by_its_job(here: World, client: Client) -> None:
    """The stored plan is made worse than the one that the proof finds."""
    mission = planned(here, client)
    Mission.objects.filter(pk=mission.pk).update(total_length_m=2.0 * (mission.total_length_m or 0.0))
    job = proof_of(client, mission)
    proof_tasks.prove_mission(str(job.pk))
    worse = client.get(f"/api/v1/missions/{mission.pk}").json()["plan"]
    assert (worse["is_proven"], worse["gap"]) == (False, pytest.approx(0.5, abs=1e-4))
    chosen = patch(client, f"missions/{mission.pk}", {"plan": True, "plan_of": str(job.pk)})
    assert chosen.status_code == 200
    plan = chosen.json()["plan"]
    assert (plan["total_length_m"], plan["is_proven"], plan.get("proof")) == (pytest.approx(mission.total_length_m), True, None)


def test_a_stopped_proof_keeps_what_it_knows(here: World, client: Client) -> None:
    mission = planned(here, client)
    job = proof_of(client, mission)
    with mock.patch("workspace.jobs.job_watch.JobWatch.stop", return_value=True):
        proof_tasks.prove_mission(str(job.pk))
    job.refresh_from_db()
    mission.refresh_from_db()
    assert job.state == "done"
    assert mission.plan_quality and mission.plan_quality["gap"] < 0.5


def test_a_plan_that_was_replaced_meanwhile_keeps_its_own_quality(here: World, client: Client) -> None:
    mission = planned(here, client)
    job = proof_of(client, mission)
    again: dict[str, Any] = {}

    def prove(*args: Any, **options: Any) -> Proof | None:
        again.update(post(client, f"missions/{mission.pk}/plan").json())
        tasks.plan_mission(again["job"])
        return None

    with mock.patch("missions.proof_tasks.prove", prove), mock.patch("planning.solver.solver.BoundedPlan.is_proven", False):
        proof_tasks.prove_mission(str(job.pk))
    mission.refresh_from_db()
    assert again
    assert "proof" not in (mission.plan_quality or {})


def test_a_proof_for_other_uavs_says_nothing_of_the_plan(here: World, client: Client) -> None:
    mission = planned(here, client)
    job = proof_of(client, mission)
    plan = make_plan(request=request_from_json(job.parameters["request"]))
    bound_m = (mission.total_length_m or 0.0) * 0.9
    as_proven = plan | {"lower_bound_m": bound_m, "is_proven": False}
    assert proven_quality(mission, as_proven)["lower_bound_m"] == bound_m
    before = mission.plan_quality
    grounded = [{"code": "out_of_service", "uav": 0}]
    for other in ({"warnings": grounded}, {"ground_revision": 0}, {"lower_bound_m": 3.0 * (mission.total_length_m or 0.0)}):
        assert proven_quality(mission, as_proven | other) == before


def test_a_plan_changed_by_hand_meanwhile_can_be_proven_anew(here: World, client: Client) -> None:
    mission = planned(here, client)
    proof_of(client, mission)
    mission.refresh_from_db()
    quality = dict(mission.plan_quality or {})
    mission.plan_quality = quality | {"method": "by hand", "planned": quality}
    after = proven_quality(mission, make_plan(request=plannable_request(mission=mission)))
    assert ("proof" in after, "proof" in after["planned"], after["method"]) == (False, False, "by hand")


def test_a_copy_has_a_proof_of_its_own(here: World, client: Client) -> None:
    mission = planned(here, client)
    job = proof_of(client, mission)
    copy = post(client, f"missions/{mission.pk}/duplicate").json()
    assert "proof" not in copy["plan"]
    assert proof_of(client, Mission.objects.get(pk=copy["id"])).pk != job.pk


def test_an_organisation_has_only_so_many_proofs_waiting(here: World, client: Client) -> None:
    mission = planned(here, client)
    Job.objects.bulk_create(Job(organisation=mission.organisation, task=PROOF_TASK, parameters={}) for _ in range(MAX_OPEN_PROOFS))
    answer = asked(client, mission)
    assert (answer.status_code, answer.json()["error"]["code"]) == (429, "too_many_jobs")


def test_a_proof_of_an_older_plan_does_not_begin(here: World, client: Client) -> None:
    mission = planned(here, client)
    job = proof_of(client, mission)
    tasks.plan_mission(post(client, f"missions/{mission.pk}/plan").json()["job"])
    proof_tasks.prove_mission(str(job.pk))
    job.refresh_from_db()
    assert (job.state, job.error["code"]) == ("failed", "mission_changed")


def test_what_cannot_be_proven_is_refused(here: World, client: Client) -> None:
    proven = planned(here, client, is_proven=True)
    Mission.objects.filter(pk=proven.pk).update(plan_quality={**(proven.plan_quality or {}), "is_proven": True})
    by_hand = planned(here, client)
    Mission.objects.filter(pk=by_hand.pk).update(plan_quality={**(by_hand.plan_quality or {}), "method": "by hand"})
    draft = Mission.objects.get(pk=post(client, "missions", mission_body({"asset": here.towers[0].pk})).json()["id"])
    for mission in (proven, by_hand, draft, planned(here, client, targets=MAX_PROVEN_TARGETS + 1)):
        answer = asked(client, mission)
        assert (answer.status_code, answer.json()["error"]["code"]) == (409, "nothing_to_prove")
    approved = planned(here, client)
    Mission.objects.filter(pk=approved.pk).update(state="approved")
    assert asked(client, approved).json()["error"]["code"] == "mission_frozen"
    assert post(client, f"missions/{uuid4()}/proof").status_code == 404


def test_only_the_worker_for_proofs_loads_ortools() -> None:
    """What imports the library, what imports that, and so on: only an option of the worker imports the task."""
    sources = {
        path.relative_to(PROJECT_DIR).as_posix(): path.read_text()
        for folder in ("config", "inspection", "missions", "operation", "planning", "results", "simulation", "telemetry", "workspace")
        for path in (PROJECT_DIR / folder).rglob("*.py")
    }

    def importers(module: str) -> list[str]:
        pattern = re.compile(rf"^\s*(?:from|import) {re.escape(module)}\b", re.M)
        return [name for name, text in sources.items() if pattern.search(text)]

    assert importers("ortools") == ["planning/solver/proof.py"]
    assert importers("planning.solver.proof") == ["missions/proof_tasks.py"]
    assert importers("missions.proof_tasks") == []
    assert ["missions.proof_tasks" in commands.worker(queue, 1) for queue in ("planning", "proofs")] == [False, True]
