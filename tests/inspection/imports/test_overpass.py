"""The visible area from Overpass: bounded, asked again when busy, refused when it is not all; the server is ours, on loopback."""

import json
from collections.abc import Iterator
from typing import Any

import pytest
from django.test import Client

from inspection.importers.osm.overpass import WrongArea, area_km2, checked_box, complaint, question
from inspection.models import Asset, DataImport
from inspection.services.imports import overpass
from inspection.tasks import apply_proposal, read_proposal
from tests.accounts.users import a_user, client_of
from tests.workspace.loopback import Server, body, serving
from workspace.models import Role

BOX = [9.0, 47.0, 9.1, 47.1]
NODES = [{"type": "node", "id": number, "lon": 9.0 + number / 100, "lat": 47.05, "tags": {"power": "tower"}} for number in (1, 2, 3)]
LINE = {"type": "way", "id": 10, "nodes": [1, 2, 3], "tags": {"power": "line", "voltage": "110000"}}


def answer(*elements: dict[str, Any], **members: Any) -> bytes:
    return json.dumps({"version": 0.6, "osm3s": {"timestamp_osm_base": "2026-11-20T10:00:00Z"}, "elements": elements, **members}).encode()


@pytest.fixture
def server(settings: Any) -> Iterator[Server]:
    with serving() as running:
        settings.OVERPASS_ADDRESS = running.address("/api/interpreter")
        settings.OUTGOING_ALLOWED_HOSTS = [f"127.0.0.1:{running.server_port}"]
        yield running


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.CURATOR))


def ask(client: Client, box: Any = BOX) -> Any:
    return client.post("/api/v1/imports", {"kind": "osm", "parameters": {"overpass_bbox": box}}, content_type="application/json")


def read(client: Client) -> dict[str, Any]:
    proposal = ask(client).json()
    read_proposal(proposal["job"]["id"])
    return client.get(f"/api/v1/imports/{proposal['id']}").json()


@pytest.mark.django_db
def test_an_area_is_taken_looked_at_and_applied(client: Client, server: Server) -> None:
    server.answers["/api/interpreter"] = body(answer(*NODES, LINE))
    ready = read(client)
    assert (ready["state"], ready["origin"], ready["difference"]["new"]) == ("ready", "overpass", 4)
    assert ready["provenance"]["licence"] == "ODbL 1.0"
    job = client.post(f"/api/v1/imports/{ready['id']}/apply", {}, content_type="application/json").json()["job"]["id"]
    apply_proposal(job)
    assert Asset.objects.count() == 4
    stored = DataImport.objects.get()
    assert (stored.source_address, stored.data_timestamp.isoformat()) == (server.address("/api/interpreter"), "2026-11-20T10:00:00+00:00")
    assert len(server.asked) == 1  # applying reads what was fetched


@pytest.mark.django_db
def test_a_busy_server_is_asked_again_and_a_refusal_is_told(client: Client, server: Server, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(overpass, "PAUSES_S", (0, 0))
    replies = iter([body(b"", 429), body(b"", 504), body(answer(*NODES))])
    server.answers["/api/interpreter"] = lambda request: next(replies)(request)
    assert read(client)["state"] == "ready"
    server.answers["/api/interpreter"] = body(b"no", 400)
    refused = read(client)
    assert (refused["state"], len(server.asked)) == ("refused", 4)
    assert refused["faults"][0]["message"].startswith("Overpass: ")


@pytest.mark.django_db
def test_an_answer_that_is_not_whole_is_refused(client: Client, server: Server) -> None:
    remark = 'runtime error: Query timed out in "query" at line 1 after 181 seconds.'
    server.answers["/api/interpreter"] = body(answer(*NODES, remark=remark))
    refused = read(client)
    assert "did not give all of it: runtime error" in refused["faults"][0]["message"]
    server.answers["/api/interpreter"] = body(answer(*NODES, LINE)[:-60])
    assert read(client)["state"] == "refused"
    assert not Asset.objects.exists()


@pytest.mark.django_db
@pytest.mark.parametrize("box", [None, [9, 47, 10], [9, 48, 10, 47], [170, 0, -170, 1], [0, 40, 30, 50], ["9", 47, 10, 48]])
def test_an_area_that_is_none_or_too_large_is_refused_at_once(client: Client, server: Server, box: Any) -> None:
    assert ask(client, box).status_code == 400
    assert server.asked == []


@pytest.mark.django_db
def test_without_a_server_in_the_settings_nothing_is_asked(client: Client, settings: Any) -> None:
    settings.OVERPASS_ADDRESS = ""
    assert ask(client).status_code == 400


def test_the_question_holds_the_box_in_overpass_own_order() -> None:
    text = question((9.0, 47.0, 9.1, 47.1), most_bytes=1_000)
    assert "[bbox:47.0000000,9.0000000,47.1000000,9.1000000]" in text
    assert "[timeout:180][maxsize:1000]" in text
    assert 'way["power"~' in text


def test_areas_are_measured_on_the_sphere() -> None:
    assert area_km2((-180, -90, 180, 90)) == pytest.approx(510_065_600, rel=1e-6)
    assert checked_box([9, 47, 9.1, 47.1], 100) == (9.0, 47.0, 9.1, 47.1)
    with pytest.raises(WrongArea, match="at most 50 km²"):
        checked_box([9, 47, 9.1, 47.1], 50)


def test_only_errors_among_remarks_count() -> None:
    assert complaint('"remark": "runtime error: out of memory"}') == "runtime error: out of memory"
    assert complaint('"remark": "4 areas"}') == complaint("]}") == ""
