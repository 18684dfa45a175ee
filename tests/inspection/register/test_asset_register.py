"""The register of assets: filters, orders, counts, files, and edits of many at once with one way back."""

import csv
import json
import sqlite3
from datetime import datetime, timedelta
from io import StringIO
from pathlib import Path
from typing import Any

import pytest
import shapely
from django.test import Client
from django.utils import timezone

from inspection.importers.assets.geopackage import geopackage_source
from inspection.models import Asset, DataImport
from inspection.selectors import ground_revision
from inspection.services.ground import number_supports
from inspection.services.imports.regions import join_region
from inspection.views import export_files
from missions.models import InspectionTarget, Mission, MissionUav, TargetState, Uav
from tests.accounts.users import a_user, client_of
from tests.inspection.ground import bridge, line, railway, tower, zone
from workspace.models import AuditEntry, Organisation, Role, User

pytestmark = pytest.mark.django_db
SPAN = ((10.0, 56.0), (10.01, 56.0), (10.02, 56.0))


@pytest.fixture
def curator() -> User:
    return a_user(Role.CURATOR)


@pytest.fixture
def client(curator: User) -> Client:
    return client_of(curator)


def ids(client: Client, query: str) -> list[int]:
    answer = client.get(f"/api/v1/assets?{query}")
    assert answer.status_code == 200, answer.content
    return [feature["id"] for feature in answer.json()["features"]]


def a_line(**facts: Any) -> tuple[Asset, list[Asset]]:
    """A 110 kV line of Nordnet on three towers, of which the last states its own voltage and operator."""
    of_line = line(*SPAN, voltages_v=[110_000], operator="Nordnet", ref="L1", **facts)
    towers = [tower(SPAN[0], ref="T10"), tower(SPAN[1], ref="T9"), tower(SPAN[2], voltages_v=[20_000], operator="Städtische")]
    Asset.objects.filter(pk=of_line.pk).update(node_osm_ids=[row.osm_id for row in towers])
    number_supports()
    return of_line, towers


def post(client: Client, path: str, body: dict[str, Any]) -> Any:
    return client.post(f"/api/v1/assets/{path}", body, content_type="application/json")


def inspect(user: User, asset: Asset, at: datetime, *, simulated: bool = False, state: TargetState = TargetState.COMPLETE) -> None:
    mission = Mission.objects.create(organisation=user.organisation, name="Round")
    uav = Uav.objects.create(organisation=user.organisation, name=f"UAV {mission.pk}", is_simulated=simulated, location=asset.centre)
    MissionUav.objects.create(mission=mission, sequence=0, uav=uav, name=uav.name, start=asset.centre, cruise_speed_mps=10.0)
    InspectionTarget.objects.create(mission=mission, sequence=0, asset=asset, label="x", state=state, state_at=at)


# Filters


def test_supports_without_a_voltage_or_an_operator_have_those_of_their_line(client: Client) -> None:
    of_line, (first, second, third) = a_line()
    far = line((11.0, 56.0), (11.01, 56.0), voltages_v=[380_000, 110_000], operator="Andere")
    assert ids(client, "voltage_v=110000") == [of_line.pk, first.pk, second.pk, far.pk]
    assert ids(client, "voltage_v=20000&voltage_v=380000") == [third.pk, far.pk]
    assert ids(client, "operator=Nordnet") == [of_line.pk, first.pk, second.pk]
    assert ids(client, "operator=St%C3%A4dtische") == [third.pk]
    assert ids(client, f"line={of_line.pk}") == [first.pk, second.pk, third.pk]
    assert ids(client, f"line={first.pk}") == []


def test_a_region_has_what_imports_brought_into_it(client: Client) -> None:
    data_import = DataImport.objects.create(kind="osm", file_name="jura.osm.pbf", sha256="j")
    inside, _drawn = tower(data_import=data_import), tower()
    region = join_region(data_import)
    assert region is not None
    assert ids(client, f"region={region.pk}") == [inside.pk]
    assert client.get(f"/api/v1/assets?region={region.pk}").json()["features"][0]["properties"]["region"] == region.pk
    assert ids(client, f"region={region.pk + 1}") == []


def test_last_inspections_are_of_aircraft_of_the_own_organisation_that_completed_it(client: Client, curator: User) -> None:
    now = timezone.now().replace(microsecond=0)
    old, new, simulated, failed, foreign = (tower() for _ in range(5))
    inspect(curator, old, now - timedelta(days=900))
    inspect(curator, new, now - timedelta(days=900))
    inspect(curator, new, now - timedelta(days=9))
    inspect(curator, simulated, now, simulated=True)
    inspect(curator, failed, now, state=TargetState.FAILED)
    inspect(a_user(Role.OPERATOR, organisation=Organisation.objects.create(name="Other")), foreign, now)
    year_ago = (now - timedelta(days=365)).date().isoformat()
    assert ids(client, "inspected=true") == [old.pk, new.pk]
    assert ids(client, "inspected=false") == [simulated.pk, failed.pk, foreign.pk]
    assert ids(client, f"inspected_before={year_ago}") == [old.pk]
    assert ids(client, f"inspected_from={year_ago}") == [new.pk]
    assert ids(client, "sort=-inspected")[:2] == [new.pk, old.pk]
    told = client.get(f"/api/v1/assets/{new.pk}").json()["properties"]["inspected_at"]
    assert datetime.fromisoformat(told) == now - timedelta(days=9)


@pytest.mark.parametrize(
    "query", ["voltage_v=x", "region=0", "line=-1", "sort=colour", "inspected=maybe", "inspected_from=then", "operator=" + "x" * 256]
)
def test_a_filter_that_makes_no_sense_is_refused(client: Client, query: str) -> None:
    for path in ("assets", "assets/summary") if not query.startswith("sort") else ("assets",):
        assert client.get(f"/api/v1/{path}?{query}").status_code == 400


# Orders


@pytest.mark.parametrize("order", ["name", "kind", "voltage", "operator", "height", "length", "changed", "inspected"])
def test_every_order_pages_through_all_assets_once_in_both_directions(client: Client, order: str) -> None:
    a_line(length_m=900.0)
    tower((10.5, 56.0), height_m=40.0)
    tower((10.5, 56.1), height_m=40.0, name="B")
    bridge((10.6, 56.0))
    railway((10.7, 56.0), (10.71, 56.0), length_m=300.0)
    whole = ids(client, f"sort={order}")
    assert sorted(whole) == sorted(Asset.objects.values_list("pk", flat=True))
    assert ids(client, f"sort=-{order}") == whole[::-1]
    paged, address = [], f"/api/v1/assets?sort={order}&limit=2"
    while address and len(paged) <= len(whole):
        page = client.get(address).json()
        paged += [feature["id"] for feature in page["features"]]
        address = page["next"]
    assert paged == whole


def test_names_without_case_come_before_assets_without_a_name(client: Client) -> None:
    nameless, beta, alpha = tower(), tower(name="beta"), tower(ref="Alpha")
    assert ids(client, "sort=name") == [alpha.pk, beta.pk, nameless.pk]


# Counts


def test_counts_of_a_fact_disregard_the_filter_by_it(client: Client) -> None:
    a_line()
    bridge(operator="Straßenamt")
    whole = client.get("/api/v1/assets/summary").json()
    assert whole == {
        "total": 5,
        "kinds": {"line": 1, "tower": 3, "bridge": 1},
        "voltages": [{"voltage_v": 110_000, "count": 3}, {"voltage_v": 20_000, "count": 1}],
        "operators": [{"operator": "Nordnet", "count": 3}, {"operator": "Straßenamt", "count": 1}, {"operator": "Städtische", "count": 1}],
    }
    narrowed = client.get("/api/v1/assets/summary?kind=tower&voltage_v=110000").json()
    assert (narrowed["total"], narrowed["kinds"], narrowed["voltages"]) == (2, {"line": 1, "tower": 2}, [
        {"voltage_v": 110_000, "count": 2}, {"voltage_v": 20_000, "count": 1},
    ])  # fmt: skip
    assert client.get("/api/v1/assets/summary?text=L1").json()["total"] == 1


@pytest.mark.parametrize(
    "query",
    ["", "kind=tower", "voltage_v=110000&kind=tower,line", "operator=Nordnet", "operator=Nordnet&kind=line", "bbox=10.005,55,10.4,57"],
)
def test_the_total_is_the_number_of_listed_assets(client: Client, query: str) -> None:
    a_line()
    bridge(operator="Nordnet")
    assert client.get(f"/api/v1/assets/summary?{query}").json()["total"] == len(ids(client, query))


# Files


def content(answer: Any) -> bytes:
    return b"".join(answer.streaming_content)


def test_a_table_has_what_is_filtered_and_no_formulas(client: Client) -> None:
    _line, (first, second, _third) = a_line()
    Asset.objects.filter(pk=first.pk).update(name="=1+1")
    answer = client.get("/api/v1/assets/export.csv?kind=tower&operator=Nordnet")
    assert answer["Content-Disposition"] == 'attachment; filename="assets.csv"'
    rows = list(csv.DictReader(StringIO(content(answer).decode())))
    assert [(row["id"], row["name"], row["line_label"]) for row in rows] == [(str(first.pk), "'=1+1", "L1"), (str(second.pk), "", "L1")]
    assert (rows[0]["longitude_deg"], rows[0]["latitude_deg"]) == ("10.0000000", "56.0000000")


def test_geojson_has_the_geometries(client: Client) -> None:
    of_line, _towers = a_line()
    (feature,) = json.loads(content(client.get("/api/v1/assets/export.geojson?kind=line")))["features"]
    assert feature["id"] == of_line.pk
    assert feature["geometry"]["coordinates"] == [list(position) for position in SPAN]
    assert feature["properties"]["voltages_v"] == "110000"


def test_a_geopackage_has_a_layer_for_each_kind_and_is_read_again(client: Client, tmp_path: Path) -> None:
    a_line()
    bridge()
    path = tmp_path / "assets.gpkg"
    path.write_bytes(content(client.get("/api/v1/assets/export.gpkg")))
    database = sqlite3.connect(path)
    assert database.execute("PRAGMA application_id").fetchone() == (0x47504B47,)
    assert database.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    types = dict(database.execute("SELECT table_name, geometry_type_name FROM gpkg_geometry_columns"))
    assert types == {"bridges": "MULTIPOLYGON", "lines": "LINESTRING", "towers": "POINT"}
    box = database.execute("SELECT min_x, min_y, max_x, max_y FROM gpkg_contents WHERE table_name = 'towers'").fetchone()
    assert box == pytest.approx((10.0, 56.0, 10.02, 56.0))
    database.close()
    with geopackage_source(path, "lines", has_system=False) as source:
        (row,) = source.rows()
        assert (row.properties["ref"], row.properties["operator"]) == ("L1", "Nordnet")
        assert shapely.get_coordinates(shapely.from_geojson(json.dumps(row.geometry))).tolist() == [list(position) for position in SPAN]


def test_nothing_to_export_is_said(client: Client) -> None:
    answer = client.get("/api/v1/assets/export.gpkg")
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "nothing_found")
    assert client.get("/api/v1/assets/export.exe").status_code == 404


def test_more_than_a_file_may_have_is_refused(client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(export_files, "MAX_EXPORTED", 1)
    for add, path in ((tower, "assets/export.csv"), (zone, "zones/export.csv")):
        add()
        assert client.get(f"/api/v1/{path}").status_code == 200
        add()
        answer = client.get(f"/api/v1/{path}")
        assert (answer.status_code, answer.json()["error"]["code"]) == (409, "too_many")


# Edits


def test_many_are_corrected_with_a_history_each_and_undone_together(client: Client, curator: User) -> None:
    _line, towers = a_line()
    revision = ground_revision()
    answer = post(client, "edits?kind=tower", {"expected": 3, "values": {"operator": "Neu", "height_m": 31.5}})
    assert answer.status_code == 200, answer.content
    assert answer.json()["changed"] == 3
    changed = list(Asset.objects.filter(kind="tower").order_by("pk"))
    assert {(row.operator, row.height_m, row.is_edited, row.revision) for row in changed} == {("Neu", 31.5, True, 2)}
    assert ground_revision() == revision + 1
    history = client.get(f"/api/v1/assets/{towers[2].pk}/history").json()["results"]
    assert (history[0]["before"]["operator"], history[0]["after"]["operator"]) == ("Städtische", "Neu")
    client.patch(f"/api/v1/assets/{towers[0].pk}", {"name": "Since"}, content_type="application/json", headers={"If-Match": "*"})
    assert post(client, "edits/undo", {"entries": answer.json()["entries"]}).json() == {"undone": 2, "kept": 1}
    assert list(Asset.objects.filter(kind="tower").order_by("pk").values_list("operator", "is_edited")) == [
        ("Neu", True), ("", False), ("Städtische", False),
    ]  # fmt: skip
    assert AuditEntry.objects.filter(actor=curator, action="reverted").count() == 2


def test_a_voltage_of_a_line_is_stored_highest_first_and_counts_for_its_supports(client: Client) -> None:
    of_line, _towers = a_line()
    post(client, "edits", {"ids": [of_line.pk], "values": {"voltages_v": [110_000, 380_000], "circuits": 3}})
    of_line.refresh_from_db()
    assert (of_line.voltages_v, of_line.max_voltage_v, of_line.circuits) == ([380_000, 110_000], 380_000, 3)
    assert client.get("/api/v1/assets/summary?voltage_v=380000").json()["kinds"] == {"line": 1, "tower": 2}


def test_what_is_so_already_is_no_change(client: Client) -> None:
    row = tower(operator="Nordnet")
    assert post(client, "edits", {"ids": [row.pk], "values": {"operator": "Nordnet"}}).json() == {"changed": 0, "entries": []}
    assert not AuditEntry.objects.exists()


@pytest.mark.parametrize(
    ("body", "status"),
    [
        ({"expected": 2, "values": {"operator": "Neu"}}, 409),
        ({"values": {"operator": "Neu"}}, 400),
        ({"expected": 5, "ids": [1], "values": {"operator": "Neu"}}, 400),
        ({"expected": 5, "values": {}}, 400),
        ({"expected": 5, "values": {"height_m": -1}}, 400),
        ({"expected": 5, "values": {"name": "Same for all"}}, 400),
        ({"expected": 5, "values": {"circuits": 2}}, 400),
    ],
)
def test_what_cannot_be_changes_nothing(client: Client, body: dict[str, Any], status: int) -> None:
    a_line()
    bridge()
    assert post(client, "edits", body).status_code == status
    assert not AuditEntry.objects.exists()


def test_operators_edit_nothing() -> None:
    row = tower()
    other = client_of(a_user(Role.OPERATOR))
    assert post(other, "edits", {"ids": [row.pk], "values": {"operator": "Neu"}}).status_code == 403
    assert post(other, "edits/undo", {"entries": [1]}).status_code == 403


def test_entries_of_other_changes_are_not_undone_in_part(client: Client) -> None:
    row = tower()
    client.patch(f"/api/v1/assets/{row.pk}", {"name": "Neu"}, content_type="application/json", headers={"If-Match": "*"})
    entry = AuditEntry.objects.get()
    assert post(client, "edits/undo", {"entries": [entry.pk]}).json() == {"undone": 0, "kept": 1}
    row.refresh_from_db()
    assert row.name == "Neu"


# Missions of an asset


def test_a_line_has_the_missions_of_its_supports_and_those_of_others_stay_hidden(client: Client, curator: User) -> None:
    now = timezone.now().replace(microsecond=0)
    of_line, (first, second, _third) = a_line()
    inspect(curator, first, now)
    inspect(curator, of_line, now, simulated=True, state=TargetState.PENDING)
    inspect(curator, tower((11.0, 56.0)), now)
    stranger = a_user(Role.OPERATOR, organisation=Organisation.objects.create(name="Other"))
    inspect(stranger, second, now)
    rows = client.get(f"/api/v1/assets/{of_line.pk}/missions").json()["results"]
    assert [(row["target_count"], row["inspected_count"], row["is_simulated"]) for row in rows] == [(1, 0, True), (1, 1, False)]
    assert len(client.get(f"/api/v1/assets/{first.pk}/missions").json()["results"]) == 1
    assert client.get(f"/api/v1/assets/{second.pk}/missions").json()["results"] == []
    assert client.get("/api/v1/assets/999/missions").status_code == 404
    Mission.objects.update(deleted_at=now)
    assert client.get(f"/api/v1/assets/{of_line.pk}/missions").json()["results"] == []
