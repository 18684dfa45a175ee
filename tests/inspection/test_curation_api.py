"""Curators draw, correct and take back: nothing is overwritten that somebody has not seen, and everything can be brought back."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from rest_framework.test import APIClient

from inspection.models import Asset, NoFlyZone
from inspection.selectors import ground_revision
from inspection.services import import_osm
from tests.workspace.api.described_answers import openapi_document, validate
from workspace.models import AuditEntry, Organisation, Role, User

pytestmark = pytest.mark.django_db
REGIONS = ["quillmoor.osm.pbf", "liechtenstein-2021-infra.osm.pbf"]
SQUARE = {"type": "Polygon", "coordinates": [[[9.5, 47.1], [9.6, 47.1], [9.6, 47.2], [9.5, 47.2], [9.5, 47.1]]]}
BOWTIE = {"type": "Polygon", "coordinates": [[[9.5, 47.1], [9.6, 47.2], [9.6, 47.1], [9.5, 47.2], [9.5, 47.1]]]}


def client_of(name: str, role: Role) -> APIClient:
    client = APIClient()
    client.force_authenticate(User.objects.create_user(name, role=role))
    return client


@pytest.fixture
def cora() -> APIClient:
    return client_of("cora", Role.CURATOR)


@pytest.fixture
def carl() -> APIClient:
    return client_of("carl", Role.CURATOR)


def point(lon: float, lat: float) -> dict[str, Any]:
    return {"type": "Point", "coordinates": [lon, lat]}


def new_tower(client: APIClient, **facts: Any) -> Any:
    return client.post("/api/v1/assets", {"kind": "tower", "geometry": point(9.5, 47.1)} | facts, format="json")


def new_zone(client: APIClient, **facts: Any) -> Any:
    return client.post("/api/v1/zones", {"name": "Works", "geometry": SQUARE} | facts, format="json")


def test_a_drawn_tower_is_on_the_ground_and_in_the_history(cora: APIClient) -> None:
    revision = ground_revision()
    answer = new_tower(cora, ref="18", voltages_v=[20_000, 110_000], height_m=31.5, tags={"power": "tower"})
    assert answer.status_code == 201, answer.data
    assert answer.headers["ETag"] == '"1"'
    properties = answer.data["properties"]
    assert (properties["label"], properties["voltages_v"], properties["is_edited"]) == ("18", [110_000, 20_000], True)
    history = cora.get(f"/api/v1/assets/{answer.data['id']}/history").data["results"]
    assert [(entry["action"], entry["actor"], entry["before"]) for entry in history] == [("created", "cora", None)]
    assert ground_revision() == revision + 1


@pytest.mark.parametrize("role", [Role.VIEWER, Role.OPERATOR])
def test_only_curators_draw(role: Role) -> None:
    assert new_tower(client_of("other", role)).status_code == 403
    assert new_zone(client_of("another", role)).status_code == 403


def test_a_change_without_if_match_is_refused(cora: APIClient) -> None:
    asset = new_tower(cora).data["id"]
    assert cora.patch(f"/api/v1/assets/{asset}", {"ref": "19"}, format="json").status_code == 428
    assert cora.delete(f"/api/v1/assets/{asset}").status_code == 428


def test_the_second_of_two_curators_sees_what_the_first_did_and_overwrites_nothing(cora: APIClient, carl: APIClient) -> None:
    created = new_tower(cora, ref="18")
    address = f"/api/v1/assets/{created.data['id']}"
    seen = created.headers["ETag"]
    assert cora.patch(address, {"ref": "18a"}, format="json", headers={"If-Match": seen}).status_code == 200
    late = carl.patch(address, {"ref": "18b"}, format="json", headers={"If-Match": seen})
    assert late.status_code == 412
    details = late.data["error"]["details"]
    assert (details["changed_by"], details["current"]["properties"]["ref"]) == ("cora", "18a")
    assert Asset.objects.get().ref == "18a"
    assert carl.delete(address, headers={"If-Match": seen}).status_code == 412
    history = cora.get(f"{address}/history").data["results"]
    assert [(entry["before"], entry["after"]) for entry in history[:1]] == [({"ref": "18"}, {"ref": "18a"})]


def test_a_revert_brings_back_what_was_before_a_change_and_is_a_change_itself(cora: APIClient) -> None:
    created = new_tower(cora, ref="18", height_m=30.0)
    address = f"/api/v1/assets/{created.data['id']}"
    first = cora.patch(address, {"ref": "19", "geometry": point(9.6, 47.2)}, format="json", headers={"If-Match": '"1"'})
    cora.patch(address, {"height_m": 40.0}, format="json", headers={"If-Match": first.headers["ETag"]})
    changed = cora.get(f"{address}/history").data["results"][1]
    assert cora.post(f"{address}/revert", {"entry": changed["id"]}, format="json", headers={"If-Match": '"2"'}).status_code == 412
    answer = cora.post(f"{address}/revert", {"entry": changed["id"]}, format="json", headers={"If-Match": '"3"'})
    properties = answer.data["properties"]
    assert (properties["ref"], properties["height_m"], properties["centre"]) == ("18", 30.0, [9.5, 47.1])
    assert AuditEntry.objects.order_by("-pk").first().action == "reverted"
    assert AuditEntry.objects.count() == 4


def test_a_deleted_asset_comes_back_under_its_own_id(cora: APIClient) -> None:
    created = new_tower(cora, ref="18", tags={"power": "tower"})
    asset = created.data["id"]
    assert cora.delete(f"/api/v1/assets/{asset}", headers={"If-Match": '"1"'}).status_code == 204
    assert cora.get(f"/api/v1/assets/{asset}").status_code == 404
    entry = cora.get(f"/api/v1/assets/{asset}/history").data["results"][0]
    restored = cora.post(f"/api/v1/history/{entry['id']}/undo")
    assert restored.status_code == 200, restored.data
    assert (restored.data["id"], restored.data["properties"]["ref"], restored.data["properties"]["tags"]) == (
        asset,
        "18",
        {"power": "tower"},
    )


def test_undo_of_a_creation_takes_the_asset_away(cora: APIClient) -> None:
    created = new_tower(cora)
    entry = AuditEntry.objects.get()
    assert cora.post(f"/api/v1/history/{entry.pk}/undo").status_code == 204
    assert cora.get(f"/api/v1/assets/{created.data['id']}").status_code == 404


def test_an_older_change_is_not_undone_over_a_newer_one(cora: APIClient) -> None:
    created = new_tower(cora)
    cora.patch(f"/api/v1/assets/{created.data['id']}", {"ref": "19"}, format="json", headers={"If-Match": "*"})
    first = AuditEntry.objects.order_by("pk").first()
    answer = cora.post(f"/api/v1/history/{first.pk}/undo")
    assert (answer.status_code, answer.data["error"]["code"]) == (409, "cannot_undo")
    assert Asset.objects.get().ref == "19"


@pytest.mark.parametrize("name", REGIONS)
def test_what_was_taken_off_by_hand_stays_off_over_the_next_import(name: str, cora: APIClient, region_file: Callable[[str], Path]) -> None:
    file = region_file(name)
    import_osm(path=file)
    tower = Asset.objects.filter(kind="tower").first()
    address = f"/api/v1/assets/{tower.pk}"
    assert cora.delete(address, headers={"If-Match": "*"}).status_code == 204
    import_osm(path=file)
    assert Asset.objects.get(pk=tower.pk).vanished_at is not None
    back = cora.post(f"{address}/follow-source", headers={"If-Match": "*"})
    assert (back.status_code, back.data["properties"]["vanished_at"], back.data["properties"]["is_edited"]) == (200, None, False)


@pytest.mark.parametrize("name", REGIONS)
def test_an_edit_that_says_again_what_the_source_says_is_no_edit(name: str, cora: APIClient, region_file: Callable[[str], Path]) -> None:
    import_osm(path=region_file(name))
    line = Asset.objects.filter(kind="line").first()
    nodes, line_name = line.node_osm_ids, line.name
    address = f"/api/v1/assets/{line.pk}"
    moved = [[lon, lat + 0.001] for lon, lat in line.geometry.coords]
    edited = cora.patch(
        address, {"name": "By hand", "geometry": {"type": "LineString", "coordinates": moved}}, format="json", headers={"If-Match": "*"}
    )
    assert (edited.data["properties"]["is_edited"], edited.data["properties"]["follows"]) == (True, True)
    followed = cora.post(f"{address}/follow-source", headers={"If-Match": "*"})
    assert followed.data["properties"]["is_edited"] is False
    line.refresh_from_db()
    assert (line.name, line.node_osm_ids, line.source_facts) == (line_name, nodes, None)


@pytest.mark.parametrize(
    ("facts", "place"),
    [
        ({"geometry": {"type": "Point", "coordinates": [47.1, 109.5]}}, "geometry.coordinates"),
        ({"geometry": {"type": "Point", "coordinates": [9.5]}}, "geometry.coordinates"),
        ({"geometry": SQUARE}, "geometry"),
        ({"kind": "line", "geometry": {"type": "LineString", "coordinates": [[9.5, 47.1], [9.5, 47.1]]}}, "geometry.coordinates"),
        ({"kind": "bridge", "geometry": BOWTIE}, "geometry.coordinates[0]"),
    ],
)
def test_a_wrong_geometry_is_refused_with_its_place(cora: APIClient, facts: dict[str, Any], place: str) -> None:
    answer = new_tower(cora, **facts)
    assert (answer.status_code, answer.data["error"]["code"]) == (400, "invalid_geometry")
    assert answer.data["error"]["details"]["place"].startswith(place.split("[")[0])
    assert not Asset.objects.exists()


@pytest.mark.parametrize(
    "facts",
    [
        {"voltages_v": [0]},
        {"voltages_v": [3_000_000]},
        {"height_m": -1},
        {"circuits": 0},
        {"kind": "pylon"},
        {"tags": {"a": "\x00"}},
        {"name": "x" * 300},
    ],
)
def test_impossible_facts_are_refused(cora: APIClient, facts: dict[str, Any]) -> None:
    assert new_tower(cora, **facts).status_code == 400
    assert not Asset.objects.exists()


def test_a_zone_with_a_hole_heights_and_a_circle_keeps_what_was_said(cora: APIClient) -> None:
    hole = [[9.52, 47.12], [9.54, 47.12], [9.54, 47.14], [9.52, 47.14], [9.52, 47.12]]
    limits = {"lower_limit": {"value_m": 0, "reference": "AGL"}, "upper_limit": {"value_m": 120, "reference": "AMSL"}}
    zone = new_zone(cora, geometry={"type": "Polygon", "coordinates": [SQUARE["coordinates"][0], hole]}, **limits)
    assert zone.status_code == 201, zone.data
    assert zone.data["properties"]["upper_limit"] == {"value_m": 120.0, "reference": "AMSL"}
    assert NoFlyZone.objects.get().geometry.num_points == 10
    circle = new_zone(cora, geometry=None, circle={"centre": [9.5, 47.1], "radius_m": 500})
    assert circle.status_code == 201, circle.data
    assert circle.data["properties"]["circle"] == {"centre": [9.5, 47.1], "radius_m": 500.0}
    assert circle.data["properties"]["lower_limit"] is None


def test_a_height_without_a_reference_is_refused(cora: APIClient) -> None:
    assert new_zone(cora, upper_limit={"value_m": 120}).status_code == 400
    below = {"lower_limit": {"value_m": 200, "reference": "AGL"}, "upper_limit": {"value_m": 120, "reference": "AGL"}}
    assert new_zone(cora, **below).status_code == 400
    assert not NoFlyZone.objects.exists()


def test_a_circle_drawn_anew_as_an_area_is_no_circle_any_more(cora: APIClient) -> None:
    zone = new_zone(cora, circle={"centre": [9.5, 47.1], "radius_m": 500})
    changed = cora.patch(f"/api/v1/zones/{zone.data['id']}", {"geometry": SQUARE}, format="json", headers={"If-Match": '"1"'})
    assert changed.data["properties"]["circle"] is None
    moved = cora.patch(
        f"/api/v1/zones/{zone.data['id']}", {"circle": {"centre": [9.6, 47.1], "radius_m": 50}}, format="json", headers={"If-Match": '"2"'}
    )
    assert moved.data["properties"]["circle"]["radius_m"] == 50.0


def test_a_zone_is_reverted_and_a_deleted_one_restored(cora: APIClient, carl: APIClient) -> None:
    zone = new_zone(cora).data["id"]
    address = f"/api/v1/zones/{zone}"
    carl.patch(address, {"name": "Yard"}, format="json", headers={"If-Match": '"1"'})
    assert cora.patch(address, {"name": "Site"}, format="json", headers={"If-Match": '"1"'}).status_code == 412
    entry = cora.get(f"{address}/history").data["results"][0]
    assert (entry["actor"], entry["before"], entry["after"]) == ("carl", {"name": "Works"}, {"name": "Yard"})
    assert (
        cora.post(f"{address}/revert", {"entry": entry["id"]}, format="json", headers={"If-Match": '"2"'}).data["properties"]["name"]
        == "Works"
    )
    assert cora.delete(address, headers={"If-Match": '"3"'}).status_code == 204
    assert not NoFlyZone.objects.exists()
    gone = AuditEntry.objects.order_by("-pk").first()
    assert cora.post(f"/api/v1/history/{gone.pk}/undo").data["id"] == zone
    assert NoFlyZone.objects.get().name == "Works"


@pytest.mark.parametrize("new", [new_tower, new_zone])
def test_what_undo_answers_is_what_the_openapi_document_says(new: Callable[[APIClient], Any], cora: APIClient) -> None:
    address = f"/api/v1/{'assets' if new is new_tower else 'zones'}/{new(cora).data['id']}"
    cora.delete(address, headers={"If-Match": "*"})
    entry = AuditEntry.objects.order_by("-pk").first()
    assert entry is not None
    undone = cora.post(f"/api/v1/history/{entry.pk}/undo")
    document = openapi_document()
    described = document["paths"]["/api/v1/history/{entry_id}/undo"]["post"]["responses"]["200"]["content"]["application/json"]["schema"]
    validate(json.loads(undone.content), described, document)


def test_the_history_of_all_tells_who_did_what(cora: APIClient, carl: APIClient) -> None:
    new_tower(cora)
    new_zone(carl)
    everything = cora.get("/api/v1/history").data["results"]
    assert [(entry["actor"], entry["subject_type"]) for entry in everything] == [("carl", "zone"), ("cora", "asset")]
    assert [entry["actor"] for entry in cora.get("/api/v1/history?actor=cora").data["results"]] == ["cora"]
    assert cora.get("/api/v1/history?subject_type=mission").status_code == 400


def test_histories_of_missions_of_others_are_no_part_of_the_ground(cora: APIClient) -> None:
    other = Organisation.objects.create(name="Others")
    AuditEntry.objects.create(organisation=other, action="created", subject_type="mission", subject_id="7", after={"name": "Secret"})
    assert cora.get("/api/v1/history").data["results"] == []
    assert cora.post(f"/api/v1/history/{AuditEntry.objects.get().pk}/undo").status_code == 404


def test_a_geometry_is_checked_without_being_stored(cora: APIClient) -> None:
    fine = cora.post("/api/v1/geometry-checks", {"kind": "zone", "geometry": SQUARE}, format="json").data
    assert fine["valid"]
    assert fine["area_m2"] == pytest.approx(84.4e6, rel=0.01)  # 7.59 km by 11.12 km
    wrong = cora.post("/api/v1/geometry-checks", {"kind": "zone", "geometry": BOWTIE}, format="json").data
    assert not wrong["valid"]
    assert wrong["fault"]["position"] == pytest.approx([9.55, 47.15])
    line = {"type": "LineString", "coordinates": [[9.5, 47.1], [9.5, 47.2]]}
    assert cora.post("/api/v1/geometry-checks", {"kind": "line", "geometry": line}, format="json").data["length_m"] == pytest.approx(
        11_119, rel=1e-3
    )
    assert not NoFlyZone.objects.exists()


def test_a_schedule_is_kept_in_its_one_form_and_said_in_words(cora: APIClient) -> None:
    schedule = [{"endDateTime": "2026-12-31T23:59:00Z", "schedule": [{"day": ["MON", "FRI"], "startTime": "08:00Z", "endEvent": "SS"}]}]
    zone = new_zone(cora, schedule=schedule)
    assert zone.data["properties"]["schedule"][0]["schedule"][0]["startTime"] == "08:00:00Z"
    assert zone.data["properties"]["schedule_words"] == "Mon, Fri 08:00 to sunset UTC, until 31 Dec 2026"
    wrong = new_zone(cora, schedule=[{"schedule": [{"day": ["FUNDAY"]}]}])
    assert (wrong.status_code, wrong.data["error"]["details"]["place"]) == (400, "schedule[0].schedule[0].day")


def test_what_is_saved_again_as_it_was_is_no_change(cora: APIClient) -> None:
    tower = new_tower(cora, ref="18").data["id"]
    zone = new_zone(cora).data["id"]
    assert cora.patch(f"/api/v1/assets/{tower}", {"ref": "18"}, format="json", headers={"If-Match": '"1"'}).headers["ETag"] == '"1"'
    assert cora.patch(f"/api/v1/zones/{zone}", {"name": "Works"}, format="json", headers={"If-Match": '"1"'}).headers["ETag"] == '"1"'
    assert AuditEntry.objects.count() == 2
