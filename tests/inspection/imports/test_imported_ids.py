"""A column of an asset file gives assets the external ids of the organisation whose file it is."""

from pathlib import Path
from typing import Any

import pytest
from django.test import Client

from inspection.importers.assets.mapping import MAX_EXTERNAL_ID
from inspection.models import Asset, AssetReference, DataImport
from inspection.selectors import ground_revision
from inspection.services import AssetFileError, import_assets
from inspection.services.curation import save_asset_reference
from inspection.services.imports.uploads import store_upload
from inspection.tasks import apply_proposal, read_proposal
from tests.accounts.users import a_user, client_of
from tests.inspection.importers.assets.made_files import geojson, line, point
from workspace.api.external_data import MAX_EXTERNAL_ID_LENGTH
from workspace.models import AuditEntry, Organisation, Role, User

pytestmark = pytest.mark.django_db
COLUMNS = {"kind": "tower", "columns": {"key": "id", "external_id": "sap"}}
Ids = dict[str, str]


def bring_in(folder: Path, ids: Ids, *, actor: User | None = None, name: str = "masts", parameters: dict[str, Any] = COLUMNS) -> DataImport:
    """Towers by key, each with its id."""
    rows = [({"id": key, "sap": external_id}, point(8.0 + 0.01 * number, 47.0)) for number, (key, external_id) in enumerate(ids.items())]
    return import_assets(path=geojson(folder / f"{name}.geojson", *rows), parameters=parameters, imported_by=actor)


def ids_of(organisation: int = 1) -> Ids:
    kept = AssetReference.objects.filter(organisation=organisation).exclude(external_id="")
    return dict(kept.values_list("asset__source_key", "external_id").order_by("asset__source_key"))


def test_a_column_gives_ids_and_the_ground_stays_as_it_is(tmp_path: Path, curator: User) -> None:
    assert bring_in(tmp_path, {"a": "", "b": ""}).counts["external_ids"] == 0
    revision = ground_revision()
    found = bring_in(tmp_path, {"a": "SAP-1", "b": ""}, actor=curator)
    assert found.counts["external_ids"] == 1
    assert ids_of() == {"a": "SAP-1"}
    asset = Asset.objects.get(source_key="a")
    assert asset.is_edited is False
    entry = AuditEntry.objects.get(subject_type="asset_reference")
    assert (entry.actor, entry.subject_id, entry.before["external_id"], entry.after["external_id"]) == (curator, str(asset.pk), "", "SAP-1")
    assert (ground_revision(), asset.tags) == (revision, {"id": "a"}), "all organisations read tags"
    assert (found.counts["changed"], asset.revision) == (0, 2)
    assert bring_in(tmp_path, {"a": "SAP-1", "b": ""}).counts["external_ids"] == 0
    assert AuditEntry.objects.filter(subject_type="asset_reference").count() == 1


def test_an_empty_cell_leaves_the_id_and_attributes_stay(tmp_path: Path, curator: User) -> None:
    bring_in(tmp_path, {"a": "", "b": ""})
    for key in "ab":
        values = {"external_id": f"OWN-{key}", "attributes": {"plant": key}}
        save_asset_reference(asset=Asset.objects.get(source_key=key), actor=curator, values=values)
    bring_in(tmp_path, {"a": "SAP-1", "b": ""})
    assert ids_of() == {"a": "SAP-1", "b": "OWN-b"}
    assert set(AssetReference.objects.values_list("attributes__plant", flat=True)) == {"a", "b"}


def test_ids_are_exchanged_and_go_from_what_has_vanished(tmp_path: Path) -> None:
    bring_in(tmp_path, {"a": "1", "b": "2", "c": "3", "d": ""})
    bring_in(tmp_path, {"a": "2", "b": "1", "d": "3"})
    assert ids_of() == {"a": "2", "b": "1", "d": "3"}
    bring_in(tmp_path, {"a": "2", "b": "", "d": "1"})
    assert ids_of() == {"a": "2", "d": "1"}


def test_an_id_that_an_asset_outside_the_set_has_refuses_the_file(tmp_path: Path) -> None:
    bring_in(tmp_path, {"a": "SAP-1"}, name="others")
    with pytest.raises(AssetFileError, match="the external id 'SAP-1' is another asset's"):
        bring_in(tmp_path, {"b": "SAP-1"})
    assert (Asset.objects.count(), ids_of()) == (1, {"a": "SAP-1"})
    bring_in(tmp_path, {"z": ""}, name="others")  # the other vanishes
    bring_in(tmp_path, {"b": "SAP-1"})
    assert ids_of() == {"b": "SAP-1"}


def test_ids_of_other_organisations_stand_beside_it(tmp_path: Path, curator: User) -> None:
    bring_in(tmp_path, {"a": "SAP-1"}, actor=curator)
    other = a_user(Role.CURATOR, organisation=Organisation.objects.create(name="Others"))
    bring_in(tmp_path, {"a": "SAP-1", "b": "SAP-2"}, actor=other)
    assert ids_of() == {"a": "SAP-1"}
    assert ids_of(other.organisation_id) == {"a": "SAP-1", "b": "SAP-2"}


@pytest.mark.parametrize(("ids", "fault"), [
    ({"a": "SAP-1", "b": "SAP-1"}, "the external id 'SAP-1' stands at"),
    ({"a": "x" * 201}, "has at most 200 characters"),
    ({"a": "SAP\u202e1"}, "no control characters"),
])  # fmt: skip
def test_ids_that_cannot_be_are_faults_of_their_rows(tmp_path: Path, ids: Ids, fault: str) -> None:
    with pytest.raises(AssetFileError, match=fault):
        bring_in(tmp_path, ids)
    assert MAX_EXTERNAL_ID == MAX_EXTERNAL_ID_LENGTH


def test_a_line_in_several_parts_has_its_id_once(tmp_path: Path) -> None:
    apart = {"type": "MultiLineString", "coordinates": [line((8.0, 47.0), (8.1, 47.0))["coordinates"], [[8.3, 47.0], [8.4, 47.0]]]}
    path = geojson(tmp_path / "lines.geojson", ({"id": "L", "sap": "SAP-L"}, apart))
    import_assets(path=path, parameters=COLUMNS | {"kind": "line"})
    assert ids_of() == {"L": "SAP-L"}


def test_by_the_api_they_are_those_of_whoever_sent_the_file(tmp_path: Path, curator: User) -> None:
    sender = a_user(Role.CURATOR, organisation=Organisation.objects.create(name="Others"))
    rows = [({"id": "a", "sap": "SAP-1"}, point(8.0, 47.0))]
    content = geojson(tmp_path / "masts.geojson", *rows).read_bytes()
    upload = store_upload(file_name="masts.geojson", chunks=[content], created_by=None)
    body = {"kind": "assets", "upload": str(upload.pk), "parameters": COLUMNS}
    proposal = client_of(sender).post("/api/v1/imports", body, content_type="application/json").json()
    read_proposal(proposal["job"]["id"])
    client: Client = client_of(curator)
    read = client.get(f"/api/v1/imports/{proposal['id']}").json()
    assert (read["state"], read["summary"]["external_ids"]) == ("ready", 1), read
    applying = client.post(f"/api/v1/imports/{proposal['id']}/apply", {}, content_type="application/json").json()
    apply_proposal(applying["job"]["id"])
    assert (ids_of(), ids_of(sender.organisation_id)) == ({}, {"a": "SAP-1"})


def test_other_organisations_see_the_column_without_its_ids(tmp_path: Path, curator: User) -> None:
    file = geojson(tmp_path / "masts.geojson", ({"id": "a", "sap": "SAP-1"}, point(8.0, 47.0)))
    upload = store_upload(file_name="masts.geojson", chunks=[file.read_bytes()], created_by=None)
    body = {"kind": "assets", "upload": str(upload.pk), "parameters": COLUMNS}
    made = client_of(curator).post("/api/v1/imports", body, content_type="application/json").json()
    read_proposal(made["job"]["id"])
    stranger = client_of(a_user(Role.CURATOR, organisation=Organisation.objects.create(name="Other")))
    own, foreign = (reader.get(f"/api/v1/imports/{made['id']}") for reader in (client_of(curator), stranger))
    assert b"SAP-1" in own.content
    assert foreign.status_code == 200
    assert b"SAP-1" not in foreign.content
    columns = {column["name"]: column for column in foreign.json()["summary"]["columns"]}
    assert (columns["sap"]["samples"], columns["sap"]["is_withheld"], columns["id"]["samples"]) == ([], True, ["a"])
