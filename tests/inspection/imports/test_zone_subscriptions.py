"""What is fetched for zone sets: proposed, never put in place unasked, and never from inside our own walls."""

import json
import threading
from collections.abc import Iterator
from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest
from django.db import connections
from django.test import Client
from django.utils import timezone

from inspection.models import ImportProposal, NoFlyZone, Upload, ZoneSet, ZoneSubscription
from inspection.services import delete_zone
from inspection.services.imports import subscriptions
from inspection.services.imports.subscriptions import start_due_fetches
from inspection.services.imports.uploads import upload_folder
from inspection.tasks import fetch_due_subscriptions, fetch_subscription
from tests.accounts.users import a_user, client_of
from tests.inspection.imports.zone_sets import SETS, SUBSCRIPTIONS, applied, names, post, read, stored, subscribed, zone_file
from tests.workspace.loopback import Server, body, serving
from workspace.http_client import Fetched, fetch
from workspace.models import AuditEntry, Job, JobState, Role, User

pytestmark = pytest.mark.django_db


@pytest.fixture
def source(settings: Any) -> Iterator[Server]:
    """The authority's server: /zones.json answers what a test puts there."""
    with serving() as server:
        settings.OUTGOING_ALLOWED_HOSTS = [f"127.0.0.1:{server.server_port}"]
        yield server


def fetched_by_the_clock() -> ZoneSubscription:
    """The time has come: the beat's task, then a worker's."""
    ZoneSubscription.objects.update(next_fetch_at=timezone.now())
    fetch_due_subscriptions()
    for job in Job.objects.filter(state=JobState.QUEUED, task="inspection.tasks.fetch_subscription"):
        fetch_subscription(str(job.pk))
    return ZoneSubscription.objects.select_related("proposal").get()


def test_a_change_besides_the_usual_facts_is_shown_by_its_own_key(client: Client, source: Server, tmp_path: Path) -> None:
    stored(tmp_path, ("A", 9.0))
    changed = json.loads(zone_file(("A", 9.0)))
    changed["features"][0]["properties"]["phone"] = "112"
    source.answers["/zones.json"] = body(json.dumps(changed).encode())
    subscribed(client, source)
    proposal = read(fetched_by_the_clock().proposal)
    change = proposal.changes.get()
    assert (change.action, change.before, change.after) == ("changed", {"properties": {}}, {"properties": {"phone": "112"}})


def test_what_is_fetched_is_proposed_and_replaces_nothing_before_a_curator_applies_it(
    client: Client, source: Server, tmp_path: Path
) -> None:
    stored(tmp_path, ("A", 9.0))
    source.answers["/zones.json"] = body(zone_file(("A", 9.0), ("B", 9.2)), ETag='"v2"')
    subscribed(client, source, licence="CC BY 4.0", attribution="The office")
    proposal = read(fetched_by_the_clock().proposal)
    assert (proposal.origin, proposal.state, proposal.difference["new"], names()) == ("subscription", "ready", 1, ["A"])
    applied(client, proposal)
    assert names() == ["A", "B"]
    stated = client.get(f"{SETS}/{ZoneSet.objects.get().pk}").json()["source"]
    assert (stated["licence"], stated["attribution"], stated["source_address"]) == (
        "CC BY 4.0", "The office", source.address("/zones.json"),
    )  # fmt: skip
    assert stated["fetched_at"] is not None


def test_an_unchanged_source_moves_the_time_of_the_fetch_alone(client: Client, source: Server, tmp_path: Path) -> None:
    stored(tmp_path, ("A", 9.0))
    source.answers["/zones.json"] = body(zone_file(("A", 9.0)), ETag='"v1"')
    subscribed(client, source)
    first = fetched_by_the_clock()
    assert (first.proposal, first.etag, first.fetched_at is not None) == (None, '"v1"', True)
    source.answers["/zones.json"] = body(b"", 304)
    second = fetched_by_the_clock()
    assert source.asked[1][2]["If-None-Match"] == '"v1"'
    assert (second.proposal, second.problem, second.fetched_at > first.fetched_at) == (None, "", True)
    assert (ImportProposal.objects.count(), Upload.objects.count()) == (0, 0)


def test_other_bytes_that_say_the_same_zones_are_no_news(client: Client, source: Server, tmp_path: Path) -> None:
    stored(tmp_path, ("A", 9.0))
    source.answers["/zones.json"] = body(zone_file(("A", 9.0), generated="2026-08-01T00:00:00Z"))
    subscribed(client, source)
    assert fetched_by_the_clock().proposal is None


def test_what_a_curator_threw_away_is_not_proposed_again_by_the_clock_but_on_demand(client: Client, source: Server) -> None:
    source.answers["/zones.json"] = body(zone_file(("A", 9.0)))
    subscription = subscribed(client, source)
    thrown = read(fetched_by_the_clock().proposal)
    assert post(client, f"/api/v1/imports/{thrown.pk}/discard").status_code == 200
    assert fetched_by_the_clock().proposal == thrown
    job = post(client, f"{SUBSCRIPTIONS}/{subscription['id']}/fetch").json()["job"]
    fetch_subscription(job)
    again = ZoneSubscription.objects.get().proposal
    assert (again != thrown, again.state) == (True, "reading")
    assert client.get(f"/api/v1/jobs/{job}").json()["result"] == {"proposal": str(again.pk), "is_new": True}


def test_an_undecided_proposal_gives_way_to_a_newer_file(client: Client, source: Server) -> None:
    source.answers["/zones.json"] = body(zone_file(("A", 9.0)))
    subscribed(client, source)
    older = read(fetched_by_the_clock().proposal)
    source.answers["/zones.json"] = body(zone_file(("A", 9.1)))
    newer = fetched_by_the_clock().proposal
    older.refresh_from_db()
    assert (older.state, newer.state, newer != older) == ("discarded", "reading", True)


def test_an_undecided_proposal_is_dropped_when_the_source_goes_back(client: Client, source: Server, tmp_path: Path) -> None:
    stored(tmp_path, ("A", 9.0))
    source.answers["/zones.json"] = body(zone_file(("A", 9.1)))
    subscribed(client, source)
    older = read(fetched_by_the_clock().proposal)
    source.answers["/zones.json"] = body(zone_file(("A", 9.0)))
    fetched_by_the_clock()
    older.refresh_from_db()
    assert older.state == "discarded"


def test_a_file_with_faults_is_a_refused_proposal_and_the_set_stays(client: Client, source: Server, tmp_path: Path) -> None:
    stored(tmp_path, ("A", 9.0))
    source.answers["/zones.json"] = body(b"<html>Moved</html>")
    subscribed(client, source)
    assert read(fetched_by_the_clock().proposal).state == "refused"
    assert names() == ["A"]


def test_failures_are_told_counted_and_tried_again_less_and_less_often(client: Client, source: Server) -> None:
    source.answers["/zones.json"] = body(b"", 500)
    subscribed(client, source)
    waits = []
    for _ in range(3):
        subscription = fetched_by_the_clock()
        waits.append(round((subscription.next_fetch_at - timezone.now()) / timedelta(minutes=1)))
    assert (subscription.failures, waits) == (3, [15, 30, 60])
    assert subscription.problem == "127.0.0.1 answers 500 Internal Server Error."
    assert Job.objects.latest("created_at").state == JobState.FAILED
    source.answers["/zones.json"] = body(zone_file(("A", 9.0)))
    subscription = fetched_by_the_clock()
    assert (subscription.failures, subscription.problem, subscription.proposal is not None) == (0, "", True)
    assert list(upload_folder().glob("spanwise-upload-*")) == []


def test_a_source_that_asks_to_wait_is_left_alone_as_long(client: Client, source: Server) -> None:
    source.answers["/zones.json"] = body(b"", 429, Retry_After="7200")
    subscribed(client, source, interval_h=1)
    assert fetched_by_the_clock().next_fetch_at > timezone.now() + timedelta(minutes=119)


def test_a_source_that_leads_into_our_own_network_is_not_followed(client: Client, source: Server) -> None:
    with serving() as inside:
        source.answers["/zones.json"] = body(b"", 302, Location=inside.address("/secret"))
        subscribed(client, source)
        assert "not a host of the public internet" in fetched_by_the_clock().problem
        assert inside.asked == []


@pytest.mark.parametrize(
    "address",
    ["http://127.0.0.1:1/", "http://[::1]/zones", "https://user:word@example.org/", "file:///etc/hostname", "example.org/zones", "", None],
)
def test_an_address_that_is_never_fetched_is_not_stored(address: Any, client: Client) -> None:
    assert post(client, SUBSCRIPTIONS, set_name="Works", address=address).status_code == 400
    assert not ZoneSet.objects.exists()


def test_a_set_is_fetched_from_one_place(client: Client, source: Server) -> None:
    subscribed(client, source)
    answer = post(client, SUBSCRIPTIONS, set_name="Works", address="https://example.org/zones")
    assert (answer.status_code, ZoneSubscription.objects.count()) == (409, 1)


def test_a_subscription_is_changed_paused_and_ended(client: Client, source: Server) -> None:
    source.answers["/zones.json"] = body(zone_file(("A", 9.0)), ETag='"v1"')
    address = f"{SUBSCRIPTIONS}/{subscribed(client, source)['id']}"
    fetched_by_the_clock()
    changed = client.patch(address, {"interval_h": 6}, content_type="application/json").json()
    assert changed["interval_h"] == 6
    assert ZoneSubscription.objects.get().next_fetch_at < timezone.now() + timedelta(hours=6)
    client.patch(address, {"is_active": False}, content_type="application/json")
    ZoneSubscription.objects.update(next_fetch_at=timezone.now())
    assert start_due_fetches() == []
    client.patch(address, {"address": source.address("/new.json"), "is_active": True}, content_type="application/json")
    subscription = ZoneSubscription.objects.get()
    assert (subscription.etag, subscription.sha256, subscription.fetched_at) == ("", "", None)
    assert client.delete(address).status_code == 204
    assert client.get(SUBSCRIPTIONS).json() == {"results": [], "next": None}
    actions = AuditEntry.objects.filter(subject_type="zone_subscription").order_by("pk").values_list("action", flat=True)
    assert list(actions) == ["created", "changed", "changed", "changed", "deleted"]


def test_an_answer_of_an_address_that_was_changed_meanwhile_counts_nothing(
    client: Client, source: Server, monkeypatch: pytest.MonkeyPatch
) -> None:
    subscription = subscribed(client, source)

    def change_and_answer(path: Path, **options: Any) -> Fetched:
        ZoneSubscription.objects.update(address="https://example.org/other")
        return fetch(source.address("/zones.json"), to=path, max_bytes=options["max_bytes"])

    source.answers["/zones.json"] = body(zone_file(("A", 9.0)))
    monkeypatch.setattr(subscriptions, "fetch", lambda address, *, to, **options: change_and_answer(to, **options))
    fetch_subscription(post(client, f"{SUBSCRIPTIONS}/{subscription['id']}/fetch").json()["job"])
    assert (ImportProposal.objects.count(), ZoneSubscription.objects.get().sha256) == (0, "")
    assert Job.objects.get().message == "The subscription was changed meanwhile."


def test_asking_twice_fetches_once(client: Client, source: Server) -> None:
    address = f"{SUBSCRIPTIONS}/{subscribed(client, source)['id']}/fetch"
    assert post(client, address).json() == post(client, address).json()
    ZoneSubscription.objects.update(next_fetch_at=timezone.now())
    assert start_due_fetches() == []
    assert Job.objects.count() == 1


def test_a_job_delivered_twice_fetches_once(client: Client, source: Server) -> None:
    source.answers["/zones.json"] = body(zone_file(("A", 9.0)))
    job = post(client, f"{SUBSCRIPTIONS}/{subscribed(client, source)['id']}/fetch").json()["job"]
    fetch_subscription(job)
    fetch_subscription(job)
    assert (len(source.asked), ImportProposal.objects.count()) == (1, 1)


@pytest.mark.django_db(transaction=True)
def test_two_clocks_at_once_start_each_fetch_once() -> None:
    for number in range(6):
        zone_set = ZoneSet.objects.create(name=f"set {number}")
        ZoneSubscription.objects.create(zone_set=zone_set, address="https://example.org/zones", next_fetch_at=timezone.now())
    started: list[Job] = []
    barrier = threading.Barrier(3)

    def beat() -> None:
        barrier.wait()
        started.extend(start_due_fetches())
        connections.close_all()

    beats = [threading.Thread(target=beat) for _ in range(3)]
    for thread in beats:
        thread.start()
    for thread in beats:
        thread.join()
    assert sorted(job.parameters["subscription"] for job in started) == sorted(ZoneSubscription.objects.values_list("pk", flat=True))


def test_a_zone_that_was_deleted_by_hand_is_proposed_on_demand_as_new(
    client: Client, curator: User, source: Server, tmp_path: Path
) -> None:
    stored(tmp_path, ("A", 9.0), ("B", 9.2))
    delete_zone(zone=NoFlyZone.objects.get(name="A"), actor=curator)
    source.answers["/zones.json"] = body(zone_file(("A", 9.0), ("B", 9.2)))
    job = post(client, f"{SUBSCRIPTIONS}/{subscribed(client, source)['id']}/fetch").json()["job"]
    fetch_subscription(job)
    assert read(ZoneSubscription.objects.get().proposal).difference["new"] == 1


@pytest.mark.parametrize("role", [Role.VIEWER, Role.OPERATOR])
def test_everybody_reads_and_only_curators_change(role: Role, client: Client, source: Server, tmp_path: Path) -> None:
    stored(tmp_path, ("A", 9.0))
    subscription, key = subscribed(client, source)["id"], ZoneSet.objects.get().pk
    other = client_of(a_user(role))
    for address in (SETS, f"{SETS}/{key}", f"{SETS}/{key}/versions", SUBSCRIPTIONS, f"{SUBSCRIPTIONS}/{subscription}"):
        assert other.get(address).status_code == 200
    assert other.delete(f"{SETS}/{key}").status_code == 403
    assert post(other, f"{SETS}/{key}/roll-back", version=1).status_code == 403
    assert post(other, SUBSCRIPTIONS, set_name="B", address="https://example.org/").status_code == 403
    assert other.patch(f"{SUBSCRIPTIONS}/{subscription}", {"is_active": False}, content_type="application/json").status_code == 403
    assert other.delete(f"{SUBSCRIPTIONS}/{subscription}").status_code == 403
    assert post(other, f"{SUBSCRIPTIONS}/{subscription}/fetch").status_code == 403
    assert names() == ["A"]
    assert (client.get(f"{SETS}/{key + 999}").status_code, client.get(f"{SUBSCRIPTIONS}/{subscription + 999}").status_code) == (404, 404)
