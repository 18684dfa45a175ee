"""What came in is looked at before it counts; of two curators one wins, and nothing is applied that nobody saw."""

import json
from datetime import timedelta
from typing import Any

import pytest
from django.db import OperationalError
from django.test import Client
from django.utils import timezone

from inspection.models import ImportProposal, NoFlyZone, ProposedChange, ZoneSetVersion
from inspection.selectors import ground_revision
from inspection.services import save_zone
from inspection.services.imports.uploads import store_upload
from inspection.services.proposals import pipeline
from inspection.tasks import apply_proposal, read_proposal, settle_proposals
from tests.accounts.users import a_user, client_of
from workspace.jobs.services import MAX_ATTEMPTS, requeue_lost_jobs, start_job
from workspace.models import AuditEntry, Job, JobState, Role, User

pytestmark = pytest.mark.django_db


def square(west: float, south: float = 47.0, side: float = 0.1) -> dict[str, Any]:
    east, north = west + side, south + side
    return {"type": "Polygon", "coordinates": [[[west, south], [east, south], [east, north], [west, north], [west, south]]]}


def zone_file(*zones: tuple[str, float]) -> bytes:
    features = [{"type": "Feature", "id": name, "properties": {"name": name}, "geometry": square(west)} for name, west in zones]
    return json.dumps({"type": "FeatureCollection", "features": features}).encode()


def propose(client: Client, content: bytes, **parameters: Any) -> dict[str, Any]:
    upload = store_upload(file_name="zones.geojson", chunks=[content], created_by=None)
    body = {"kind": "zones", "upload": str(upload.pk), "parameters": parameters, "provenance": {"licence": "CC BY 4.0"}}
    answer = client.post("/api/v1/imports", body, content_type="application/json")
    assert answer.status_code == 202, answer.content
    return answer.json()


def read(client: Client, proposal: dict[str, Any]) -> dict[str, Any]:
    read_proposal(proposal["job"]["id"])
    return client.get(f"/api/v1/imports/{proposal['id']}").json()


def post(client: Client, proposal: dict[str, Any], act: str, **parameters: Any) -> Any:
    return client.post(f"/api/v1/imports/{proposal['id']}/{act}", {"parameters": parameters}, content_type="application/json")


def apply(client: Client, proposal: dict[str, Any], **parameters: Any) -> dict[str, Any]:
    answer = post(client, proposal, "apply", **parameters)
    assert answer.status_code == 202, answer.content
    apply_proposal(answer.json()["job"]["id"])
    return client.get(f"/api/v1/imports/{proposal['id']}").json()


def names() -> list[str]:
    return sorted(NoFlyZone.objects.values_list("name", flat=True))


def test_a_difference_is_shown_and_nothing_counts_before_it_is_applied(client: Client) -> None:
    proposal = propose(client, zone_file(("A", 9.0), ("B", 9.2)))
    assert (proposal["state"], proposal["job"]["state"]) == ("reading", "queued")
    ready = read(client, proposal)
    assert (ready["state"], ready["difference"]["new"], ready["summary"]["zones"]) == ("ready", 2, 2)
    assert names() == []
    revision = ground_revision()
    applied = apply(client, ready)
    assert (applied["state"], names(), ground_revision()) == ("applied", ["A", "B"], revision + 1)
    zone = client.get(f"/api/v1/zones/{NoFlyZone.objects.first().pk}").json()
    assert zone["properties"]["source"]["file_name"] == "zones.geojson"
    assert ZoneSetVersion.objects.get().zones == 2


def test_the_next_file_of_a_set_is_told_apart_zone_by_zone(client: Client) -> None:
    apply(client, read(client, propose(client, zone_file(("A", 9.0), ("B", 9.2), ("C", 9.4)))))
    ready = read(client, propose(client, zone_file(("A", 9.0), ("B", 9.25), ("D", 9.6))))
    assert ready["difference"] == {"new": 1, "changed": 1, "vanished": 1, "kept": 0, "unchanged": 1}
    changes = client.get(f"/api/v1/imports/{ready['id']}/changes").json()["features"]
    assert {(change["properties"]["action"], change["properties"]["label"]) for change in changes} == {
        ("new", "D"),
        ("changed", "B"),
        ("vanished", "C"),
    }
    changed = client.get(f"/api/v1/imports/{ready['id']}/changes?action=changed").json()["features"]
    assert set(changed[0]["properties"]["before"]) == {"geometry"}
    apply(client, ready)
    assert names() == ["A", "B", "D"]
    assert sorted(AuditEntry.objects.filter(subject_type="zone").values_list("action", flat=True)) == ["changed", "vanished"]


def test_a_file_with_a_fault_is_refused_with_the_place_and_nothing_of_it_counts(client: Client) -> None:
    bowtie = {"type": "Polygon", "coordinates": [[[9.0, 47.0], [9.1, 47.1], [9.1, 47.0], [9.0, 47.1], [9.0, 47.0]]]}
    refused = read(client, propose(client, json.dumps(bowtie).encode()))
    assert refused["state"] == "refused"
    assert refused["faults"][0]["position"] == pytest.approx([9.05, 47.05])
    assert post(client, refused, "apply").status_code == 409
    assert names() == []


def test_an_edited_zone_is_kept_unless_somebody_says_otherwise(client: Client, curator: User) -> None:
    apply(client, read(client, propose(client, zone_file(("A", 9.0), ("B", 9.2)))))
    zone = NoFlyZone.objects.get(name="A")
    zone.reason = "Checked on site"
    save_zone(zone=zone, actor=curator)
    ready = read(client, propose(client, zone_file(("A", 9.01), ("B", 9.3))))
    assert (ready["difference"]["kept"], ready["difference"]["changed"]) == (1, 1)
    apply(client, ready)
    zone.refresh_from_db()
    assert (zone.reason, zone.is_edited, zone.geometry.extent[0]) == ("Checked on site", True, 9.0)
    apply(client, read(client, propose(client, zone_file(("A", 9.01), ("B", 9.3)), replace_edited=True)))
    zone.refresh_from_db()
    assert (zone.reason, zone.is_edited, zone.geometry.extent[0]) == ("", False, 9.01)


def test_what_changed_since_somebody_looked_is_shown_again_and_not_applied(client: Client, curator: User) -> None:
    apply(client, read(client, propose(client, zone_file(("A", 9.0), ("B", 9.2)))))
    ready = read(client, propose(client, zone_file(("A", 9.05), ("B", 9.2))))
    zone = NoFlyZone.objects.get(name="A")
    zone.reason = "Checked on site"
    save_zone(zone=zone, actor=curator)
    again = apply(client, ready)
    assert (again["state"], again["difference"]["kept"], again["difference"]["changed"]) == ("ready", 1, 0)
    assert "ground has changed" in again["job"]["message"]
    zone.refresh_from_db()
    assert zone.geometry.extent[0] == 9.0
    assert apply(client, again)["state"] == "applied"


def test_a_change_elsewhere_does_not_hold_up_what_somebody_saw(client: Client, curator: User) -> None:
    ready = read(client, propose(client, zone_file(("A", 9.0))))
    save_zone(zone=NoFlyZone(name="Other", geometry=NoFlyZone._meta.get_field("geometry").to_python(_multipolygon())), actor=curator)
    assert apply(client, ready)["state"] == "applied"


def _multipolygon() -> str:
    return "SRID=4326;MULTIPOLYGON(((1 1, 2 1, 2 2, 1 1)))"


def test_of_two_curators_who_apply_one_wins_and_the_other_hears_who(client: Client, curator: User) -> None:
    ready = read(client, propose(client, zone_file(("A", 9.0))))
    assert post(client, ready, "apply").status_code == 202
    late = post(client_of(a_user(Role.CURATOR)), ready, "discard")
    assert late.status_code == 409
    assert late.json()["error"]["details"]["decided_by"] == curator.username


def test_a_discarded_proposal_leaves_nothing_behind(client: Client) -> None:
    ready = read(client, propose(client, zone_file(("A", 9.0))))
    assert post(client, ready, "discard").json()["state"] == "discarded"
    assert ProposedChange.objects.count() == 0
    assert post(client, ready, "apply").status_code == 409


def test_a_cancelled_reading_is_discarded_and_a_cancelled_applying_waits_again(client: Client) -> None:
    proposal = propose(client, zone_file(("A", 9.0)))
    client.post(f"/api/v1/jobs/{proposal['job']['id']}/cancel")
    read_proposal(proposal["job"]["id"])
    settle_proposals()
    assert client.get(f"/api/v1/imports/{proposal['id']}").json()["state"] == "discarded"
    ready = read(client, propose(client, zone_file(("A", 9.0))))
    applying = post(client, ready, "apply").json()
    client.post(f"/api/v1/jobs/{applying['job']['id']}/cancel")
    settle_proposals()
    assert client.get(f"/api/v1/imports/{ready['id']}").json()["state"] == "ready"
    assert names() == []


def test_a_file_is_not_given_up_for_a_database_that_is_away_for_a_moment(client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is back before the worker could have written down that it failed: the job waits for its lease to end, and is taken up again."""
    proposal = propose(client, zone_file(("A", 9.0)))

    def away(**_: Any) -> None:
        raise OperationalError("the connection is lost")

    with monkeypatch.context() as patched:
        patched.setattr(pipeline, "read_proposal", away)
        with pytest.raises(OperationalError):
            read_proposal(proposal["job"]["id"])
    assert Job.objects.get().state == JobState.RUNNING
    Job.objects.update(lease_expires_at=timezone.now() - timedelta(seconds=1))
    requeue_lost_jobs()
    assert read(client, proposal)["state"] == "ready"


def test_a_worker_that_lost_its_job_writes_nothing(client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    ready = read(client, propose(client, zone_file(("A", 9.0))))
    applying = post(client, ready, "apply").json()
    monkeypatch.setattr(pipeline, "finish_job", lambda **_: False)  # another worker has it
    apply_proposal(applying["job"]["id"])
    assert names() == []


def test_a_job_that_was_delivered_twice_is_done_once(client: Client) -> None:
    ready = read(client, propose(client, zone_file(("A", 9.0))))
    job = post(client, ready, "apply").json()["job"]["id"]
    apply_proposal(job)
    apply_proposal(job)
    assert (names(), ZoneSetVersion.objects.count()) == (["A"], 1)


def test_a_worker_that_dies_again_and_again_makes_the_proposal_refused(client: Client) -> None:
    proposal = propose(client, zone_file(("A", 9.0)))
    for _ in range(MAX_ATTEMPTS):
        assert start_job(job_id=proposal["job"]["id"])
        Job.objects.update(lease_expires_at="2020-01-01T00:00Z")
    assert start_job(job_id=proposal["job"]["id"]) is None
    settle_proposals()
    refused = client.get(f"/api/v1/imports/{proposal['id']}").json()
    assert refused["state"] == "refused"
    assert "worker was lost" in refused["faults"][0]["message"]


def test_a_set_is_rolled_back_as_a_difference_like_any_other(client: Client, curator: User) -> None:
    apply(client, read(client, propose(client, zone_file(("A", 9.0), ("B", 9.2)), set_name="Works")))
    apply(client, read(client, propose(client, zone_file(("B", 9.25), ("C", 9.4)), set_name="Works")))
    version = ZoneSetVersion.objects.get(number=1)
    proposal = pipeline.start_proposal(
        kind="zones", upload=None, file_name="Works", parameters={"set": version.zone_set_id, "version": 1}, provenance={},
        created_by=curator, origin="roll_back",
    )  # fmt: skip
    read_proposal(str(proposal.job_id))
    ready = client.get(f"/api/v1/imports/{proposal.pk}").json()
    assert ready["difference"] == {"new": 1, "changed": 1, "vanished": 1, "kept": 0, "unchanged": 0}
    apply(client, ready)
    assert names() == ["A", "B"]
    assert NoFlyZone.objects.get(name="B").geometry.extent[0] == 9.2


@pytest.mark.parametrize("role", [Role.VIEWER, Role.OPERATOR])
def test_only_curators_bring_data_in(role: Role) -> None:
    other = client_of(a_user(role))
    assert other.get("/api/v1/imports").status_code == 403
    assert other.post("/api/v1/imports", {"kind": "zones"}, content_type="application/json").status_code == 403


@pytest.mark.parametrize(
    "body", [{}, {"kind": "rocks"}, {"kind": "zones"}, {"kind": "zones", "upload": "0d2f0a5e-0000-4000-8000-000000000000"}]
)
def test_a_proposal_without_its_file_is_refused(client: Client, body: dict[str, Any]) -> None:
    assert client.post("/api/v1/imports", body, content_type="application/json").status_code == 400
    assert not ImportProposal.objects.exists()
