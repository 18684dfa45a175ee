"""Asset files brought in: looked at, compared with their set, applied, and planned on."""

import json
from io import StringIO
from pathlib import Path
from typing import Any

import pytest
from django.core.management import CommandError, call_command
from django.test import Client

from inspection.models import Asset, AssetSet, DataImport, ImportProposal
from inspection.selectors import current_graph, ground_revision
from inspection.services import AssetFileError, UnfinishedMapping, build_graph, delete_asset, import_assets, save_asset
from inspection.services.imports.uploads import store_upload
from inspection.tasks import apply_proposal, read_proposal
from tests.inspection.importers.assets.made_files import geojson, line, point
from workspace.models import AuditEntry, User

pytestmark = pytest.mark.django_db

TOWERS = {"kind": "tower", "columns": {"key": "id", "ref": "ref", "height": "h"}}
Row = tuple[dict[str, Any], dict[str, Any] | None]


def row(key: str, lon: float, **facts: Any) -> Row:
    return {"id": key, "ref": f"M {key}", "h": 40} | facts, point(lon, 47.0)


def bring_in(folder: Path, *rows: Row, parameters: dict[str, Any] = TOWERS, **options: Any) -> DataImport:
    return import_assets(path=geojson(folder / "towers.geojson", *rows), parameters=parameters, **options)


def numbers(data_import: DataImport) -> tuple[int, ...]:
    return tuple(data_import.counts[name] for name in ("new", "changed", "vanished", "kept", "unchanged"))


def tower(key: str) -> Asset:
    return Asset.objects.get(source_key=key)


def test_rows_become_assets_of_their_set(tmp_path: Path) -> None:
    found = bring_in(tmp_path, row("1", 8.0), row("2", 8.01))
    assert numbers(found) == (2, 0, 0, 0, 0)
    asset = tower("1")
    assert (asset.kind, asset.ref, asset.height_m, asset.asset_set.name, asset.subtype) == ("tower", "M 1", 40.0, "towers", "tower")
    assert (asset.centre.coords, asset.tags["ref"], asset.osm_id, asset.is_edited) == ((8.0, 47.0), "M 1", None, False)
    assert AssetSet.objects.get().mapping == TOWERS


def test_the_next_file_brings_the_set_up_to_date_and_the_history_says_how(tmp_path: Path, curator: User) -> None:
    bring_in(tmp_path, row("1", 8.0), row("2", 8.01), row("3", 8.02))
    revision = ground_revision()
    found = bring_in(tmp_path, row("1", 8.0), row("2", 8.011, h=50), row("4", 8.03), imported_by=curator)
    assert numbers(found) == (1, 1, 1, 0, 1)
    assert tower("2").height_m == 50
    assert tower("3").vanished_at is not None
    assert [tower(key).revision for key in "1234"] == [1, 2, 2, 1]
    assert ground_revision() == revision + 1
    entries = {entry.subject_id: entry for entry in AuditEntry.objects.filter(subject_type="asset")}
    assert set(entries) == {str(tower("2").pk), str(tower("3").pk)}
    changed = entries[str(tower("2").pk)]
    assert (changed.actor, changed.action, changed.before["height_m"], changed.after["height_m"]) == (curator, "changed", 40, 50)
    assert entries[str(tower("3").pk)].after["vanished"] is True


def test_the_same_file_again_changes_nothing_and_is_one_import(tmp_path: Path) -> None:
    first = bring_in(tmp_path, row("1", 8.0))
    revision = ground_revision()
    assert bring_in(tmp_path, row("1", 8.0)).pk == first.pk
    assert (DataImport.objects.count(), ground_revision(), tower("1").revision) == (1, revision, 1)


def test_what_vanished_comes_back(tmp_path: Path) -> None:
    bring_in(tmp_path, row("1", 8.0), row("2", 8.01))
    bring_in(tmp_path, row("1", 8.0))
    assert numbers(bring_in(tmp_path, row("1", 8.0), row("2", 8.01))) == (0, 1, 0, 0, 1)
    assert tower("2").vanished_at is None


def test_edited_rows_stay_and_know_what_their_source_says(tmp_path: Path, curator: User) -> None:
    bring_in(tmp_path, row("1", 8.0), row("2", 8.01))
    for key in "12":
        asset = tower(key)
        asset.height_m = 44.0
        save_asset(asset=asset, actor=curator)
    assert numbers(bring_in(tmp_path, row("1", 8.0, h=60))) == (0, 0, 0, 2, 0)
    assert (tower("1").height_m, tower("1").source_facts["height_m"]) == (44.0, 60.0)
    assert (tower("2").vanished_at, tower("2").source_facts["vanished"]) == (None, True)
    assert numbers(bring_in(tmp_path, row("1", 8.0, h=60), row("3", 8.02))) == (1, 0, 0, 0, 2)


def test_an_edit_that_the_source_has_taken_over_is_none_any_more(tmp_path: Path, curator: User) -> None:
    bring_in(tmp_path, row("1", 8.0))
    asset = tower("1")
    asset.height_m = 44.0
    asset.tags = asset.tags | {"h": "44"}
    save_asset(asset=asset, actor=curator)
    bring_in(tmp_path, row("1", 8.0, h=44))
    assert (tower("1").is_edited, tower("1").source_facts) == (False, None)


def test_edited_rows_are_replaced_if_somebody_says_so(tmp_path: Path, curator: User) -> None:
    bring_in(tmp_path, row("1", 8.0), row("2", 8.01))
    asset = tower("1")
    asset.height_m = 44.0
    save_asset(asset=asset, actor=curator)
    delete_asset(asset=tower("2"), actor=curator)
    assert numbers(bring_in(tmp_path, row("1", 8.0), row("2", 8.01), replace_edited=True)) == (0, 2, 0, 0, 0)
    assert (tower("1").height_m, tower("1").is_edited, tower("2").vanished_at) == (40.0, False, None)


def test_what_a_curator_deleted_does_not_come_back(tmp_path: Path, curator: User) -> None:
    bring_in(tmp_path, row("1", 8.0))
    delete_asset(asset=tower("1"), actor=curator)
    bring_in(tmp_path, row("1", 8.0), row("2", 8.01))
    assert tower("1").vanished_at is not None


def test_sets_do_not_touch_each_other(tmp_path: Path) -> None:
    bring_in(tmp_path, row("1", 8.0), parameters=TOWERS | {"set_name": "North"})
    assert numbers(bring_in(tmp_path, row("1", 8.5), parameters=TOWERS | {"set_name": "South"})) == (1, 0, 0, 0, 0)
    assert sorted(Asset.objects.values_list("asset_set__name", "source_key")) == [("North", "1"), ("South", "1")]


def test_a_fault_in_the_last_row_leaves_everything_as_it_was(tmp_path: Path) -> None:
    bring_in(tmp_path, row("1", 8.0))
    with pytest.raises(AssetFileError, match=r"features\[1\]"):
        bring_in(tmp_path, row("2", 8.0), ({"id": "3"}, point(500, 95)))
    assert list(Asset.objects.values_list("source_key", flat=True)) == ["1"]
    assert DataImport.objects.count() == 1


def test_without_a_kind_nothing_is_written(tmp_path: Path) -> None:
    with pytest.raises(UnfinishedMapping, match="Say what the rows are"):
        bring_in(tmp_path, row("1", 8.0), parameters={})
    assert not AssetSet.objects.exists()


def test_a_line_and_its_towers_of_a_file_make_one_line_to_plan_on(tmp_path: Path, settings: Any) -> None:
    """A --- B --- C --- D, and a branch from C: towers as points, the lines drawn over them a hand's breadth off."""
    settings.GRAPH_CACHE_DIR = tmp_path / "graphs"
    lons = (8.0, 8.004, 8.008, 8.012)
    towers = [({"id": name}, point(lon, 47.0)) for name, lon in zip("ABCD", lons, strict=True)]
    main = ({"id": "L1", "kv": 220}, line(*[(lon, 47.000001) for lon in lons]))
    branch = ({"id": "L2", "kv": 110}, line((8.008, 47.0), (8.008, 47.004)))
    bring_in(
        tmp_path,
        *towers,
        main,
        branch,
        parameters={"kind": "by_geometry", "columns": {"key": "id", "voltage": "kv"}, "units": {"voltage": "kV"}},
    )
    assert [(tower(key).line.source_key, tower(key).place_on_line, tower(key).places_on_line) for key in "ABCD"] == [
        ("L1", 1, 4), ("L1", 2, 4), ("L1", 3, 4), ("L1", 4, 4),
    ]  # fmt: skip
    snapshot = build_graph()
    assert (snapshot.nodes, snapshot.edges, snapshot.components) == (5, 4, 1)
    graph = current_graph()
    assert {int(asset) for asset in graph.node_asset[:4]} == {tower(key).pk for key in "ABCD"}


# Over the API


def propose(client: Client, content: bytes, name: str = "towers.geojson", **parameters: Any) -> dict[str, Any]:
    upload = store_upload(file_name=name, chunks=[content], created_by=None)
    body = {"kind": "assets", "upload": str(upload.pk), "parameters": parameters, "provenance": {"licence": "CC0"}}
    answer = client.post("/api/v1/imports", body, content_type="application/json")
    assert answer.status_code == 202, answer.content
    return read(client, answer.json())


def read(client: Client, proposal: dict[str, Any]) -> dict[str, Any]:
    read_proposal(proposal["job"]["id"])
    return client.get(f"/api/v1/imports/{proposal['id']}").json()


def change(client: Client, proposal: dict[str, Any], **parameters: Any) -> dict[str, Any]:
    answer = client.patch(f"/api/v1/imports/{proposal['id']}", {"parameters": parameters}, content_type="application/json")
    assert answer.status_code in {200, 202}, answer.content
    return read(client, answer.json())


def apply(client: Client, proposal: dict[str, Any]) -> dict[str, Any]:
    answer = client.post(f"/api/v1/imports/{proposal['id']}/apply", {"parameters": {}}, content_type="application/json")
    assert answer.status_code == 202, answer.content
    apply_proposal(answer.json()["job"]["id"])
    return client.get(f"/api/v1/imports/{proposal['id']}").json()


CSV = b"Nr;H\xc3\xb6he;Spannung;lon;lat\nA 1;45,5;110;8,00;47,0\nA 2;38;110;8,01;47,0\n"


def test_a_table_is_shown_explained_compared_and_applied(client: Client) -> None:
    seen = propose(client, CSV, "masten.csv")
    summary = seen["summary"]
    assert (seen["state"], summary["needs_mapping"], summary["rows"], summary["geometry_types"]) == ("ready", True, 2, {"points": 2})
    assert [(column["name"], column["type"], column["suggestion"]) for column in summary["columns"]] == [
        ("Nr", "text", "ref"), ("Höhe", "number", "height"), ("Spannung", "whole number", "voltage"), ("lon", "empty", "lon"),
        ("lat", "empty", "lat"),
    ]  # fmt: skip
    assert summary["columns"][1]["samples"] == ["45,5", "38"]
    assert summary["preview"]["features"][0]["geometry"]["coordinates"] == [8.0, 47.0]
    ready = change(client, seen, set_name="Masts", **summary["suggested_mapping"])
    assert (ready["summary"]["needs_mapping"], ready["difference"]["new"]) == (False, 2)
    shown = client.get(f"/api/v1/imports/{ready['id']}/changes").json()["features"]
    assert shown[0]["properties"]["label"] == "A 1"
    assert shown[0]["properties"]["after"]["height_m"] == 45.5
    assert not Asset.objects.exists()
    applied = apply(client, ready)
    assert applied["state"] == "applied"
    assert list(Asset.objects.values_list("ref", "voltages_v", "data_import__licence")) == [
        ("A 1", [110_000], "CC0"),
        ("A 2", [110_000], "CC0"),
    ]


def test_the_next_file_of_a_set_needs_no_explanation(client: Client) -> None:
    first = propose(client, CSV, "masten.csv", set_name="Masts")
    apply(client, change(client, first, **first["summary"]["suggested_mapping"]))
    ready = propose(client, CSV.replace(b"45,5", b"46"), "masten-2027.csv", set_name="Masts")
    assert (ready["summary"]["needs_mapping"], ready["difference"]["changed"], ready["difference"]["unchanged"]) == (False, 1, 1)
    before_and_after = client.get(f"/api/v1/imports/{ready['id']}/changes?action=changed").json()["features"][0]["properties"]
    assert (before_and_after["before"]["height_m"], before_and_after["after"]["height_m"]) == (45.5, 46)


def test_only_another_system_is_no_explanation_of_the_columns(client: Client) -> None:
    first = propose(client, CSV, "masten.csv", set_name="Masts")
    seen = change(client, first, crs="EPSG:4258")
    assert (seen["summary"]["mapping"], seen["summary"]["crs"]) == ({}, "ETRS89 (EPSG:4258)")
    apply(client, change(client, seen, **first["summary"]["suggested_mapping"]))
    again = propose(client, CSV, "masten-2027.csv", set_name="Masts", crs="EPSG:4258", columns={}, kind=None)
    assert (again["summary"]["needs_mapping"], again["difference"]["unchanged"]) == (False, 2)


def test_a_table_without_known_columns_says_what_is_missing(client: Client) -> None:
    seen = propose(client, b"a;b;c\n1;47;8\n", "x.csv")
    assert seen["summary"]["needs_mapping"] is True
    assert "Say which columns hold longitude and latitude" in seen["summary"]["words"]
    ready = change(client, seen, geometry={"lon": "c", "lat": "b"}, kind="tower")
    assert ready["difference"]["new"] == 1


def test_a_value_that_nobody_explained_is_asked_for(client: Client) -> None:
    rows = b"typ,lon,lat\nMast,8,47\nHut,8.1,47\n"
    seen = propose(client, rows, "x.csv", kind={"column": "typ", "values": {"Mast": "tower"}})
    assert seen["summary"]["words"] == "Say what these values of 'typ' are, or leave their rows out: 'Hut' (1 rows)."
    ready = change(client, seen, kind={"column": "typ", "values": {"Mast": "tower", "Hut": ""}})
    assert (ready["difference"]["new"], ready["summary"]["left_out"]) == (1, {"of a kind that is not wanted": 1})


def test_a_faulty_file_is_refused_with_place_and_position_and_read_without_its_faulty_rows_on_request(client: Client) -> None:
    bowtie = {"type": "Polygon", "coordinates": [[[8, 47], [9, 48], [9, 47], [8, 48], [8, 47]]]}
    content = {
        "type": "FeatureCollection",
        "features": [{"type": "Feature", "properties": {}, "geometry": shape} for shape in (point(8, 47), bowtie)],
    }
    refused = propose(client, json.dumps(content).encode(), kind="by_geometry")
    assert refused["state"] == "refused"
    (fault,) = refused["faults"]
    assert (fault["place"], fault["message"], fault["position"]) == ("features[1].geometry.coordinates", "self-intersection", [8.5, 47.5])
    ready = change(client, refused, leave_out_faulty=True)
    assert (ready["state"], ready["difference"]["new"], ready["summary"]["faulty_rows_left_out"]) == ("ready", 1, 1)


def test_the_difference_of_a_large_set_is_cut_but_its_numbers_are_whole(client: Client) -> None:
    rows = "id,lon,lat\n" + "".join(f"{index},{8 + index * 1e-4:.4f},47\n" for index in range(2_500))
    ready = propose(client, rows.encode(), "x.csv", kind="tower", columns={"key": "id"})
    assert ready["difference"]["new"] == 2_500
    assert ImportProposal.objects.get().changes.count() == 2_000


# From the command line


def test_the_command_reads_a_file_with_a_mapping(tmp_path: Path) -> None:
    path = tmp_path / "masten.csv"
    path.write_bytes(CSV)
    out = StringIO()
    call_command("import_assets", str(path), "--set", "Masts", "--mapping", '{"kind": "tower", "columns": {"key": "Nr"}}', stdout=out)
    assert "masten.csv: csv, WGS 84" in out.getvalue()
    assert "2 new, 0 changed, 0 vanished, 0 kept, 0 unchanged" in out.getvalue()
    call_command("import_assets", str(path), "--set", "Masts", "--json", stdout=(again := StringIO()))
    assert json.loads(again.getvalue())["unchanged"] == 2


def test_the_command_says_what_is_wrong(tmp_path: Path) -> None:
    path = tmp_path / "masten.csv"
    path.write_bytes(CSV)
    with pytest.raises(CommandError, match="Say what the rows are"):
        call_command("import_assets", str(path))
    with pytest.raises(CommandError, match="The mapping cannot be read"):
        call_command("import_assets", str(path), "--mapping", "{")
    with pytest.raises(CommandError, match=r"masten.csv is refused, nothing of it was stored:\n  columns.ref: the file has no column"):
        call_command("import_assets", str(path), "--mapping", '{"kind": "tower", "columns": {"ref": "x"}}')
