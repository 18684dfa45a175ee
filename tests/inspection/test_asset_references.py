"""An organisation's own ids and attributes of assets, which all organisations share."""

import json
from pathlib import Path
from typing import Any

import pytest
from django.db import connection
from django.test import Client
from django.test.utils import CaptureQueriesContext

from inspection.models import Asset, AssetReference
from inspection.selectors import ground_revision
from inspection.services import import_osm
from tests.accounts.users import a_user, client_of
from tests.inspection.imports.osm_files import small_line, write_osm
from workspace.models import AuditEntry, Organisation, Role

pytestmark = pytest.mark.django_db
GIVEN = {"external_id": "SAP-100", "attributes": {"plant": "North", "year": 1987}}
TOWER = {"kind": "tower", "geometry": {"type": "Point", "coordinates": [9.5, 47.1]}}


@pytest.fixture
def curator() -> Client:
    return client_of(a_user(Role.CURATOR))


def write(client: Client, method: str, path: str, body: dict[str, Any], etag: str = "*") -> Any:
    return client.generic(method, f"/api/v1/{path}", json.dumps(body), content_type="application/json", headers={"If-Match": etag})


def given_of(client: Client, asset: int) -> dict[str, Any]:
    properties = client.get(f"/api/v1/assets/{asset}").json()["properties"]
    return {name: properties[name] for name in GIVEN}


def imported(tmp_path: Path) -> Asset:
    import_osm(path=write_osm(tmp_path / "a.osm", *small_line()))
    return Asset.objects.get(kind="tower", osm_id=2)


def test_an_import_leaves_them_and_the_row_as_the_source_has_it(tmp_path: Path, curator: Client) -> None:
    asset, ground = imported(tmp_path), ground_revision()
    answer = write(curator, "PATCH", f"assets/{asset.pk}", GIVEN)
    assert answer.status_code == 200, answer.content
    assert ground_revision() == ground, "no mission becomes stale"
    asset.refresh_from_db()
    assert (asset.is_edited, asset.revision) == (False, 2)
    nodes, ways = small_line()
    lon, lat, tags = nodes[2]
    nodes[2] = (lon, lat, tags | {"ref": "two"})
    import_osm(path=write_osm(tmp_path / "b.osm", nodes, ways))
    asset.refresh_from_db()
    assert asset.ref == "two", "imports still bring the row up to date"
    assert given_of(curator, asset.pk) == GIVEN


def test_they_are_one_organisations(curator: Client) -> None:
    asset = write(curator, "POST", "assets", TOWER | GIVEN).json()
    assert {name: asset["properties"][name] for name in GIVEN} == GIVEN
    other = client_of(a_user(Role.CURATOR, Organisation.objects.create(name="Other")))
    assert given_of(other, asset["id"]) == {"external_id": "", "attributes": {}}
    assert other.get("/api/v1/assets?external_id=SAP-100").json()["features"] == []
    assert write(other, "PATCH", f"assets/{asset['id']}", {"external_id": "mine"}).status_code == 200
    assert given_of(curator, asset["id"]) == GIVEN
    assert "SAP-100" not in other.get(f"/api/v1/assets/{asset['id']}/history").content.decode()
    assert "SAP-100" not in other.get("/api/v1/history").content.decode()


def test_an_external_id_is_of_one_asset_and_finds_it(curator: Client) -> None:
    first = write(curator, "POST", "assets", TOWER | GIVEN).json()["id"]
    second = write(curator, "POST", "assets", TOWER | GIVEN)
    assert (second.status_code, second.json()["error"]["code"]) == (409, "external_id_taken")
    assert Asset.objects.count() == 1, "nothing is left behind"
    [found] = curator.get("/api/v1/assets?external_id=SAP-100").json()["features"]
    assert (found["id"], found["properties"]["attributes"]) == (first, GIVEN["attributes"])


def test_a_change_needs_the_asset_as_it_is_and_is_audited(curator: Client) -> None:
    made = write(curator, "POST", "assets", TOWER | GIVEN)
    path = f"assets/{made.json()['id']}"
    both = write(curator, "PATCH", path, {"name": "Hill", "attributes": {}}, made["ETag"])
    assert both.status_code == 200, both.content
    assert (both.json()["properties"]["name"], both.json()["properties"]["attributes"]) == ("Hill", {})
    late = write(curator, "PATCH", path, {"external_id": "late"}, made["ETag"])
    assert (late.status_code, late.json()["error"]["details"]["current"]["properties"]["external_id"]) == (412, "SAP-100")
    entry = AuditEntry.objects.filter(subject_type="asset_reference").latest("recorded_at")
    assert (entry.before, entry.after) == (GIVEN, GIVEN | {"attributes": {}})
    revision = Asset.objects.get().revision
    write(curator, "PATCH", path, {"attributes": {}})
    assert Asset.objects.get().revision == revision, "said again it is no change"


def test_only_curators_write_them(curator: Client) -> None:
    asset = write(curator, "POST", "assets", TOWER).json()["id"]
    assert write(client_of(a_user(Role.OPERATOR)), "PATCH", f"assets/{asset}", GIVEN).status_code == 403
    assert not AssetReference.objects.exists()


def test_the_list_reads_them_in_one_query(curator: Client) -> None:
    for number in range(3):
        write(curator, "POST", "assets", TOWER | {"external_id": f"SAP-{number}"})
    with CaptureQueriesContext(
        connection,
    ) as queries:
        features = curator.get("/api/v1/assets").json()["features"]
    assert [feature["properties"]["external_id"] for feature in features] == ["SAP-0", "SAP-1", "SAP-2"]
    assert sum("inspection_assetreference" in query["sql"] for query in queries.captured_queries) == 1


def test_an_asset_that_is_brought_back_has_them_again(curator: Client) -> None:
    asset = write(curator, "POST", "assets", TOWER | GIVEN).json()["id"]
    other = client_of(a_user(Role.CURATOR, Organisation.objects.create(name="Other")))
    write(other, "PATCH", f"assets/{asset}", {"external_id": "mine"})
    assert curator.delete(f"/api/v1/assets/{asset}", headers={"If-Match": "*"}).status_code == 204
    assert not AssetReference.objects.exists()
    taken = write(other, "POST", "assets", TOWER | {"external_id": "mine"}).json()["id"]
    entry = AuditEntry.objects.filter(subject_type="asset", subject_id=str(asset)).latest("recorded_at")
    assert write(curator, "POST", f"history/{entry.pk}/undo", {}).status_code == 200
    assert given_of(curator, asset) == GIVEN
    assert given_of(other, asset)["external_id"] == "", "it is another asset's by now"
    assert given_of(other, taken)["external_id"] == "mine"
