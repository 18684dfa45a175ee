"""Findings: made from photos, worked on, verified by a later photo alone, and exported."""

import csv
import io
import json
from datetime import timedelta
from typing import Any

import pytest
from django.test import Client
from django.utils import timezone

from results.categories import BY_CODE, CATEGORIES, COMPONENTS
from results.finding_states import FindingState, after_observation, may_set
from results.models import Finding, Medium
from tests.accounts.users import a_user, client_of
from tests.inspection import ground
from tests.results.photos import dji_photo, file_of, picture
from tests.results.sending import upload, upload_and_read
from workspace.models import AuditEntry, Organisation, Role

pytestmark = pytest.mark.django_db
FINDINGS = "/api/v1/findings"
BOX = {"type": "box", "x": 20.0, "y": 10.0, "width": 60.0, "height": 40.0}


@pytest.fixture
def client() -> Client:
    return client_of(a_user())


def photo(client: Client, taken_at: str = "2026-06-01T08:00:00", **stated: Any) -> Medium:
    return upload_and_read(client, dji_photo(UTCAtExposure=taken_at), **stated)


def post(client: Client, path: str, **body: Any) -> Any:
    return client.post(f"{FINDINGS}{path}", body, content_type="application/json")


def create(client: Client, *media: Medium, **values: Any) -> Any:
    body = {"category": "insulator-broken", "severity": 2, "evidence": [{"medium": str(medium.pk), "shape": BOX} for medium in media]}
    return post(client, "", **body | values)


def change(client: Client, finding: str, revision: int | str = "*", **values: Any) -> Any:
    return client.patch(f"{FINDINGS}/{finding}", values, content_type="application/json", headers={"If-Match": f'"{revision}"'})


def test_a_finding_takes_what_it_shows_from_its_photo(client: Client) -> None:
    tower = ground.tower((10.004, 56.0), ref="E401-3")
    medium = photo(client, asset=tower.pk)
    answer = create(client, medium)
    assert (answer.status_code, answer["Location"]) == (201, f"{FINDINGS}/{answer.json()['id']}")
    found = answer.json()
    assert (found["number"], found["asset"], found["asset_label"], found["state"]) == (1, tower.pk, "E401-3", "open")
    assert found["position"]["coordinates"] == [10.004, 56.0]
    assert (found["first_seen_at"], found["scheme"], found["severity_source"]) == ("2026-06-01T08:00:00Z", "spanwise-1", "user")
    assert [(one["medium"], one["shape"]) for one in found["evidence"]] == [(str(medium.pk), BOX)]
    assert found["due_on"] == (timezone.now() + timedelta(days=180)).date().isoformat()
    assert client.get(f"/api/v1/media/{medium.pk}").json()["review"] == "findings"


def test_one_defect_on_several_photos_is_one_finding(client: Client) -> None:
    first, second = photo(client), photo(client, "2026-06-01T08:01:00")
    key = create(client, second).json()["id"]
    found = post(client, f"/{key}/evidence", medium=str(first.pk), shape={"type": "polygon", "points": [[1, 1], [9, 1], [9, 9]]}).json()
    assert len(found["evidence"]) == 2
    assert (found["first_seen_at"], found["last_seen_at"]) == ("2026-06-01T08:00:00Z", "2026-06-01T08:01:00Z")
    removed = client.delete(f"{FINDINGS}/{key}/evidence/{found['evidence'][1]['id']}").json()
    assert len(removed["evidence"]) == 1
    assert client.get(f"/api/v1/media/{first.pk}").json()["review"] == ""


@pytest.mark.parametrize(
    ("shape", "status"),
    [
        (BOX | {"x": 120.0}, 409),  # beyond the 160 pixels of the original
        (BOX | {"x": -1.0}, 400),
        (BOX | {"width": 0.0}, 400),
        ({"type": "box", "x": 1.0}, 400),
        ({"type": "polygon", "points": [[1, 1], [2, 2]]}, 400),
        ({"type": "polygon", "points": [[1, 1], [2, 2], [500, 3]]}, 409),
        ({"type": "circle"}, 400),
        (BOX | {"points": [[1, 1], [2, 2], [3, 3]]}, 400),
        (None, 201),
    ],
)
def test_marks_are_in_the_picture(client: Client, shape: Any, status: int) -> None:
    medium = photo(client)
    assert create(client, evidence=[{"medium": str(medium.pk), "shape": shape}]).status_code == status
    assert Finding.objects.count() == (status == 201)


def test_what_says_nothing_without_a_note_needs_one(client: Client) -> None:
    refused = create(client, category="other")
    assert (refused.status_code, list(refused.json()["error"]["details"])) == (409, ["note"])
    key = create(client, category="other", note="Sign on the wrong side").json()["id"]
    assert change(client, key, note=" ").status_code == 409
    assert create(client, category="dragon").status_code == 400
    assert create(client, severity=5).status_code == 400


def test_numbers_count_within_the_organisation(client: Client) -> None:
    other = client_of(a_user(organisation=Organisation.objects.create(name="Other")))
    assert [create(one).json()["number"] for one in (client, client, other)] == [1, 2, 1]


def test_done_is_verified_by_a_later_photo_that_does_not_show_it_and_by_nothing_else(client: Client) -> None:
    tower = ground.tower((10.004, 56.0))
    key = create(client, photo(client, asset=tower.pk)).json()["id"]
    assert change(client, key, state="work_ordered", work_reference="WO-17").json()["work_reference"] == "WO-17"
    done = change(client, key, state="done").json()
    assert done["state"] == "done" and done["done_at"] is not None
    refused = change(client, key, state="verified")
    assert (refused.status_code, list(refused.json()["error"]["details"])) == (409, ["state"])
    same_day = photo(client, "2026-06-01T09:00:00", asset=tower.pk)
    refused = post(client, f"/{key}/observations", medium=str(same_day.pk), outcome="not_seen")
    assert (refused.status_code, "before the work" in refused.json()["error"]["message"]) == (409, True)
    later = photo(client, f"{timezone.now() + timedelta(hours=2):%Y-%m-%dT%H:%M:%S}", asset=tower.pk)
    verified = post(client, f"/{key}/observations", medium=str(later.pk), outcome="not_seen").json()
    assert (verified["state"], verified["observations"][0]["outcome"]) == ("verified", "not_seen")


def test_seen_again_it_is_open_again(client: Client) -> None:
    tower = ground.tower((10.004, 56.0))
    key = create(client, photo(client, asset=tower.pk)).json()["id"]
    change(client, key, state="done")
    later = photo(client, f"{timezone.now() + timedelta(hours=2):%Y-%m-%dT%H:%M:%S}", asset=tower.pk)
    found = post(client, f"/{key}/observations", medium=str(later.pk), outcome="seen").json()
    assert (found["state"], found["last_seen_at"]) == ("open", later.taken_at.isoformat().replace("+00:00", "Z"))


def test_a_photo_of_elsewhere_or_of_before_says_nothing(client: Client) -> None:
    tower = ground.tower((10.004, 56.0))
    key = create(client, photo(client, asset=tower.pk)).json()["id"]
    for medium in (photo(client, "2027-06-01T08:00:00"), photo(client, "2025-06-01T08:00:00", asset=tower.pk)):
        assert post(client, f"/{key}/observations", medium=str(medium.pk), outcome="not_seen").status_code == 409


def test_a_photo_of_unknown_time_proves_nothing_later(client: Client) -> None:
    tower = ground.tower((10.004, 56.0))
    key = create(client, photo(client, asset=tower.pk)).json()["id"]
    change(client, key, state="done")
    undated = upload_and_read(client, file_of(picture()), asset=tower.pk)
    refused = post(client, f"/{key}/observations", medium=str(undated.pk), outcome="not_seen")
    assert (undated.taken_at, refused.status_code, Finding.objects.get(pk=key).state) == (None, 409, "done")


def test_a_photo_that_has_not_been_read_proves_nothing(client: Client) -> None:
    tower = ground.tower((10.004, 56.0))
    key = create(client, photo(client, asset=tower.pk)).json()["id"]
    later = f"{timezone.now() + timedelta(hours=2):%Y-%m-%dT%H:%M:%S}"
    waiting = upload(client, dji_photo(UTCAtExposure=later), asset=tower.pk)
    refused = post(client, f"/{key}/observations", medium=str(waiting.pk), outcome="not_seen")
    assert (refused.status_code, list(refused.json()["error"]["details"])) == (409, ["medium"])


def test_a_finding_without_an_asset_is_verified_by_no_photo(client: Client) -> None:
    key = create(client, photo(client, "2026-06-01T08:00:00")).json()["id"]
    change(client, key, state="done")
    later = photo(client, f"{timezone.now() + timedelta(hours=2):%Y-%m-%dT%H:%M:%S}")
    assert Finding.objects.get(pk=key).asset_id is None
    assert post(client, f"/{key}/observations", medium=str(later.pk), outcome="not_seen").status_code == 409


def test_states_follow_the_table() -> None:
    by_users = {
        "open": {"work_ordered", "done", "rejected"}, "work_ordered": {"open", "done", "rejected"}, "done": {"open", "work_ordered"},
        "verified": {"open"}, "rejected": {"open"},
    }  # fmt: skip
    seen = {"open": "open", "work_ordered": "work_ordered", "done": "open", "verified": "open", "rejected": "rejected"}
    for present in FindingState:
        assert {wanted for wanted in FindingState if may_set(present, wanted)} == by_users[present] | {present}
        assert after_observation(present, is_seen=True) == seen[present]
        assert after_observation(present, is_seen=False) == ("verified" if present == "done" else present)


def test_a_wrong_step_is_refused(client: Client) -> None:
    key = create(client).json()["id"]
    assert change(client, key, state="rejected").json()["state"] == "rejected"
    assert change(client, key, state="done").status_code == 409
    assert change(client, key, state="open").json()["state"] == "open"


def test_who_has_not_seen_a_change_does_not_overwrite_it(client: Client) -> None:
    found = create(client).json()
    assert change(client, found["id"], found["revision"], severity=1).json()["severity"] == 1
    refused = change(client, found["id"], found["revision"], severity=4)
    assert (refused.status_code, refused.json()["error"]["details"]["current"]["severity"]) == (412, 1)
    assert client.patch(f"{FINDINGS}/{found['id']}", {"severity": 3}, content_type="application/json").status_code == 428


def test_every_change_is_in_the_history(client: Client) -> None:
    medium = photo(client)
    key = create(client, medium).json()["id"]
    change(client, key, severity=1, note="Two discs")
    post(client, f"/{key}/evidence", medium=str(medium.pk))
    entries = client.get(f"{FINDINGS}/{key}/history").json()["results"]
    assert [entry["action"] for entry in entries] == ["add-evidence", "change", "create"]
    assert (entries[1]["before"]["severity"], entries[1]["after"]["severity"], entries[1]["after"]["note"]) == (2, 1, "Two discs")
    assert AuditEntry.objects.filter(subject_type="finding").count() == 3


def test_comments_stay_with_their_author(client: Client) -> None:
    key = create(client).json()["id"]
    assert post(client, f"/{key}/comments", text="Ask the line crew").status_code == 201
    [comment] = client.get(f"{FINDINGS}/{key}").json()["comments"]
    assert (comment["text"], comment["author"]) == ("Ask the line crew", Finding.objects.get().created_by.display_name)


def test_a_photo_that_is_evidence_is_not_deleted(client: Client) -> None:
    medium = photo(client)
    create(client, medium)
    refused = client.delete(f"/api/v1/media/{medium.pk}")
    assert (refused.status_code, refused.json()["error"]["code"]) == (409, "is_evidence")
    assert Medium.objects.filter(pk=medium.pk).exists()


def test_findings_are_listed_the_worst_first_and_filtered(client: Client) -> None:
    towers = [ground.tower((10.0 + 0.004 * n, 56.0)) for n in range(2)]
    line = ground.line(*[tower.centre.coords for tower in towers], node_osm_ids=[tower.osm_id for tower in towers])
    medium = photo(client)
    keys = [
        create(client, severity=3, asset=towers[0].pk).json()["id"],
        create(client, severity=1, asset=towers[1].pk, category="tower-nest").json()["id"],
        create(client, medium, severity=4).json()["id"],
    ]
    change(client, keys[0], state="rejected")
    for query, expected in {
        "": [1, 0, 2], "state=open,done": [1, 2], "severity=3,4": [0, 2], "category=tower-nest": [1], f"asset={towers[0].pk}": [0],
        f"asset={line.pk}": [1, 0], f"medium={medium.pk}": [2], "due_before=2020-01-01": [], "limit=2": [1, 0],
    }.items():  # fmt: skip
        found = client.get(f"{FINDINGS}?{query}").json()["results"]
        assert [one["id"] for one in found] == [keys[place] for place in expected], query
    assert client.get(f"{FINDINGS}?state=closed").status_code == 400


def test_findings_are_exported(client: Client) -> None:
    tower = ground.tower((10.004, 56.0), ref="E401-3")
    create(client, photo(client, asset=tower.pk), note="=HYPERLINK(1)")
    create(client)
    table = b"".join(client.get(f"{FINDINGS}.csv").streaming_content).decode()
    first, second = csv.DictReader(io.StringIO(table))
    assert (first["number"], first["asset_label"], first["photos"], first["longitude_deg"]) == ("1", "E401-3", "1", "10.0040000")
    assert (first["note"], second["longitude_deg"]) == ("'=HYPERLINK(1)", "")
    collection = json.loads(b"".join(client.get(f"{FINDINGS}.geojson?severity=2").streaming_content))
    assert [feature["geometry"] for feature in collection["features"]] == [{"type": "Point", "coordinates": [10.004, 56.0]}, None]
    assert client.get(f"{FINDINGS}.xlsx").status_code == 404


def test_categories_have_names_in_the_readers_language(client: Client) -> None:
    found = client.get("/api/v1/finding-categories", headers={"Accept-Language": "de"}).json()
    assert found["scheme"] == "spanwise-1"
    assert {"Korrosion", "Nest"} <= {one["name"] for one in found["categories"]}
    assert len(BY_CODE) == len(CATEGORIES) and {one.component for one in CATEGORIES} == set(COMPONENTS)


@pytest.mark.parametrize("role", [Role.VIEWER, Role.CURATOR])
def test_others_read_findings_and_change_none(client: Client, role: Role) -> None:
    key = create(client).json()["id"]
    other = client_of(a_user(role))
    assert other.get(f"{FINDINGS}/{key}").status_code == 200
    assert {
        create(other).status_code,
        change(other, key, severity=1).status_code,
        post(other, f"/{key}/comments", text="x").status_code,
    } == {403}
