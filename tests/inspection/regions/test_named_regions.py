"""Each import makes a region or joins one, and every page with a map opens in the region where its user works."""

import json
import re
from pathlib import Path
from typing import Any

import pytest
from django.contrib.gis.geos import MultiPolygon, Point
from django.db import transaction
from django.test import Client

from inspection.models import Asset, DataImport, NoFlyZone, Region, TerrainTile, ZoneSet
from inspection.selectors.ground import regions_in_use
from inspection.services import import_osm
from inspection.services.ground import mark_ground_changed
from inspection.services.imports.asset_undo import undo_of, write_undo
from inspection.services.imports.regions import join_region, name_of_file
from inspection.services.regions import delete_region_of
from inspection.tasks import delete_region as delete_region_task
from missions.models import Base, Uav, UavType
from missions.services.fleet.demo_uavs import create_demo_uavs
from operation.reasons import Reason
from tests.accounts.users import a_user, client_of
from tests.inspection.ground import square, tower, zone
from tests.inspection.imports.osm_files import TOWER, small_line, write_osm
from workspace.jobs.services import JobLost
from workspace.models import AuditEntry, Job, Role

pytestmark = pytest.mark.django_db

JURA, OHIO, WAIKATO = (7.3, 47.2), (-83.0, 40.0), (175.3, -37.8)
PAGES = ("/missions/new", "/live", "/assets", "/assets/data-issues", "/imports", "/terrain", "/zones", "/uavs")


def an_import(file_name: str, centre: tuple[float, float], *, kind: str = "osm", half_deg: float = 0.2, **facts: Any) -> DataImport:
    """Import two towers at the corners of a box."""
    data_import = DataImport.objects.create(kind=kind, file_name=file_name, sha256=file_name, **facts)
    for sign in (-1, 1):
        tower((centre[0] + sign * half_deg, centre[1] + sign * half_deg), data_import=data_import)
    mark_ground_changed()
    join_region(data_import)
    return data_import


def three_continents() -> None:
    an_import("jura-latest.osm.pbf", JURA, attribution="OpenStreetMap")
    an_import("ohio.osm.pbf", OHIO)
    an_import("waikato.osm.pbf", WAIKATO)


def page_of(client: Client, address: str) -> dict[str, Any]:
    found = re.search(r'<script id="page" type="application/json">(.*?)</script>', client.get(address).content.decode())
    assert found is not None, address
    return json.loads(found[1])  # type: ignore[no-any-return]


def put_view(client: Client, place: tuple[float, float], zoom: float = 11.5) -> int:
    body = {"zoom": zoom, "longitude": place[0], "latitude": place[1]}
    return client.put("/api/v1/account/map-view", body, content_type="application/json").status_code


def holds(box: Any, place: tuple[float, float]) -> bool:
    return bool(box[0] <= place[0] <= box[2] and box[1] <= place[1] <= box[3])


def test_every_page_opens_where_its_user_worked_last_on_three_continents() -> None:
    three_continents()
    user, other = a_user(Role.ADMINISTRATOR), a_user(Role.OPERATOR)
    client, other_client = client_of(user), client_of(other)
    for place in (OHIO, JURA, WAIKATO):
        assert put_view(client, place) == 204
        assert put_view(other_client, OHIO) == 204
        for address in PAGES:
            page = page_of(client, address)
            assert holds(page["extent"], place), address
            assert page["view"] == {"zoom": 11.5, "longitude": place[0], "latitude": place[1]}
            assert [region["name"] for region in page["regions"]] == ["Jura", "Ohio", "Waikato"]
            assert holds(page_of(other_client, address)["extent"], OHIO), address


def test_a_new_user_opens_on_the_bases_and_without_any_on_the_newest_import() -> None:
    three_continents()
    user = a_user(Role.OPERATOR)
    client = client_of(user)
    assert page_of(client, "/assets")["view"] is None
    assert holds(page_of(client, "/assets")["extent"], WAIKATO)
    Base.objects.create(organisation=user.organisation, name="Delémont", location=Point(JURA, srid=4326))
    assert holds(page_of(client, "/assets")["extent"], JURA)


def test_a_view_outside_all_regions_is_kept() -> None:
    three_continents()
    client = client_of(a_user(Role.OPERATOR))
    put_view(client, (0.0, 0.0), zoom=2)
    page = page_of(client, "/assets")
    assert page["view"]["zoom"] == 2
    assert holds(page["extent"], WAIKATO)


@pytest.mark.parametrize("body", [{}, {"zoom": 3, "longitude": 200, "latitude": 0}, {"zoom": "x", "longitude": 0, "latitude": 0}])
def test_a_view_that_is_none_is_refused(body: dict[str, Any]) -> None:
    client = client_of(a_user(Role.VIEWER))
    assert client.put("/api/v1/account/map-view", body, content_type="application/json").status_code == 400


def test_a_later_file_of_the_same_place_joins_and_a_neighbour_does_not() -> None:
    first = an_import("jura.osm.pbf", JURA)
    assert an_import("jura-poles.csv", (JURA[0] + 0.1, JURA[1]), kind="assets").region_id == first.region_id
    neighbour = an_import("basel.osm.pbf", (JURA[0] + 0.49, JURA[1]))
    assert neighbour.region_id != first.region_id
    west, _, east, _ = Region.objects.get(pk=first.region_id).extent.extent
    assert (round(west, 2), round(east, 2)) == (7.1, 7.6)


def test_zones_and_terrain_join_without_making_the_region_larger() -> None:
    region = an_import("jura.osm.pbf", JURA).region
    assert region is not None
    before = region.extent.extent
    data_import = DataImport.objects.create(kind="zones", file_name="switzerland.json", sha256="z")
    zone_set = ZoneSet.objects.create(name="Switzerland", data_import=data_import)
    NoFlyZone.objects.create(zone_set=zone_set, identifier="Z1", name="All", geometry=MultiPolygon(square((8.0, 47.0), 2.0), srid=4326))
    assert join_region(data_import) == region
    assert Region.objects.get().extent.extent == before


def test_a_region_of_zones_takes_the_name_of_the_first_assets() -> None:
    data_import = DataImport.objects.create(kind="zones", file_name="zones_ch.json", sha256="z")
    zone_set = ZoneSet.objects.create(name="zones_ch", data_import=data_import)
    NoFlyZone.objects.create(zone_set=zone_set, identifier="Z1", name="All", geometry=MultiPolygon(square((8.0, 47.0), 2.0), srid=4326))
    assert join_region(data_import).name == "Zones Ch"  # type: ignore[union-attr]
    an_import("jura.osm.pbf", JURA)
    assert [row.name for row in Region.objects.all()] == ["Jura"]


def test_a_region_states_its_assets_and_sources() -> None:
    three_continents()
    tower(JURA)  # drawn by hand: of no region
    rows = client_of(a_user(Role.VIEWER)).get("/api/v1/regions").json()["results"]
    assert [(row["name"], row["counts"], row["attribution"]) for row in rows] == [
        ("Jura", {"tower": 2}, ["OpenStreetMap"]),
        ("Ohio", {"tower": 2}, []),
        ("Waikato", {"tower": 2}, []),
    ]


def test_a_region_without_data_is_not_listed() -> None:
    an_import("ohio.osm.pbf", OHIO)
    Asset.objects.update(vanished_at="2026-01-01T00:00:00Z")
    assert regions_in_use() == []


@pytest.mark.parametrize(
    ("file_name", "name"),
    [
        ("rhone-alpes-latest.osm.pbf", "Rhone Alpes"),
        ("liechtenstein-2021-01-01.osm.pbf", "Liechtenstein"),
        ("Masten_Nord.geojson", "Masten Nord"),
        ("overpass.json", ""),
    ],
)
def test_a_region_is_named_after_its_file(file_name: str, name: str) -> None:
    assert name_of_file(file_name) == name


def test_a_region_without_a_telling_file_is_named_by_its_place_and_twins_are_numbered() -> None:
    assert an_import("overpass.json", WAIKATO).region.name == "37.8° S, 175.3° E"  # type: ignore[union-attr]
    an_import("map.osm", JURA)
    assert an_import("map.osm", OHIO).region.name == "Map 2"  # type: ignore[union-attr]


def test_a_curator_renames_a_region() -> None:
    three_continents()
    region = Region.objects.get(name="Ohio")

    def rename(role: Role, name: str) -> int:
        return client_of(a_user(role)).patch(f"/api/v1/regions/{region.pk}", {"name": name}, content_type="application/json").status_code

    assert (rename(Role.OPERATOR, "Columbus"), rename(Role.CURATOR, "Jura"), rename(Role.CURATOR, "Columbus")) == (403, 409, 204)
    assert [row.name for row in Region.objects.all()] == ["Columbus", "Jura", "Waikato"]
    assert AuditEntry.objects.get(action="renamed").before == {"name": "Ohio"}


def terrain_of(data_import: DataImport, centre: tuple[float, float], half_deg: float) -> None:
    TerrainTile.objects.create(
        data_import=data_import, extent=square(centre, half_deg), west_deg=centre[0], north_deg=centre[1], step_lon_deg=1, step_lat_deg=1,
        columns=1, rows=1, heights_amsl_m=b"",
    )  # fmt: skip


def zones_and_terrain(name: str, half_deg: float, **facts: Any) -> list[Region | None]:
    """Import a zone and terrain around the Jura. Returns the regions that they joined."""
    zones = DataImport.objects.create(kind="zones", file_name=f"{name}.json", sha256=f"z{name}", **facts)
    zone(JURA, half_deg, zone_set=ZoneSet.objects.create(name=name, data_import=zones))
    terrain = DataImport.objects.create(kind="terrain", file_name=f"{name}.tif", sha256=f"t{name}", **facts)
    terrain_of(terrain, JURA, half_deg)
    return [join_region(zones), join_region(terrain)]


def delete(client: Client, region: Region, **facts: Any) -> dict[str, int]:
    body = {"region_id": region.pk, **facts}
    answer = client.post("/api/v1/regions/delete", body, content_type="application/json")
    assert answer.status_code == 200
    return answer.json()["counts"]  # type: ignore[no-any-return]


def the_demo() -> Region:
    region = an_import("demo.osm.pbf", JURA, is_synthetic=True).region
    assert region is not None
    assert zones_and_terrain("demo", 0.2, is_synthetic=True) == [region, region]
    return region


def test_the_demo_goes_with_its_zones_terrain_and_uavs_and_nothing_else() -> None:
    user = a_user(Role.ADMINISTRATOR)
    an_import("ohio.osm.pbf", OHIO)
    region = the_demo()
    assert region.name == "Elme Valley"
    create_demo_uavs(organisation=user.organisation)
    client = client_of(user)
    counts = {"tower": 2, "zone": 1, "terrain": 1}
    assert delete(client, region, dry_run=True) == counts
    assert Uav.objects.exists()
    assert delete(client, region) == counts
    assert [row.name for row in regions_in_use()] == ["Ohio"]
    assert not any(model.objects.exists() for model in (NoFlyZone, TerrainTile, Uav, Base))
    assert client.post("/api/v1/regions/delete", {"region_id": 999}, content_type="application/json").status_code == 404


def test_a_curator_who_does_not_plan_deletes_the_demo_and_keeps_its_uavs() -> None:
    user = a_user(Role.CURATOR)
    region = the_demo()
    create_demo_uavs(organisation=user.organisation)
    fleet = (Uav.objects.count(), UavType.objects.count(), Base.objects.count())
    assert delete(client_of(user), region) == {"tower": 2, "zone": 1, "terrain": 1}
    assert (Uav.objects.count(), UavType.objects.count(), Base.objects.count()) == fleet
    assert regions_in_use() == []


def test_national_zones_and_terrain_survive_the_deletion_of_a_region_that_they_reach_beyond() -> None:
    region = an_import("jura.osm.pbf", JURA).region
    assert region is not None
    assert zones_and_terrain("jura", 0.1) == [region, region]
    assert zones_and_terrain("switzerland", 2.0) == [region, region]
    client = client_of(a_user(Role.CURATOR))
    counts = {"tower": 2, "zone": 1, "terrain": 1}
    assert delete(client, region, dry_run=True) == counts
    assert delete(client, region) == counts
    assert [row.zone_set.name for row in NoFlyZone.objects.all() if row.zone_set] == ["switzerland"]
    assert [row.data_import.file_name for row in TerrainTile.objects.all()] == ["switzerland.tif"]


def test_real_data_over_the_demo_make_their_own_region_and_stay_when_the_demo_goes(tmp_path: Path) -> None:
    demo = the_demo()
    nodes, ways = small_line()
    for number, (_lon, _lat, tags) in nodes.items():
        nodes[number] = (JURA[0] + 0.004 * number, JURA[1], tags)
    real = import_osm(path=write_osm(tmp_path / "jura.osm", nodes, ways)).region
    assert real is not None
    assert (real.pk != demo.pk, real.name) == (True, "Jura")
    assert delete(client_of(a_user(Role.ADMINISTRATOR)), demo) == {"tower": 2, "zone": 1, "terrain": 1}
    assert [(row.name, row.is_synthetic) for row in regions_in_use()] == [("Jura", False)]
    assert Asset.objects.filter(vanished_at=None).count() == 5


def extent_of(region: Region) -> tuple[float, ...]:
    return tuple(round(edge, 2) for edge in Region.objects.get(pk=region.pk).extent.extent)


def test_a_region_is_as_large_as_what_is_left_of_it_after_a_deletion() -> None:
    region = an_import("jura.osm.pbf", JURA, half_deg=0.1).region
    assert region is not None
    far = an_import("jura-south.osm.pbf", (JURA[0], JURA[1] - 0.15), half_deg=0.1)
    assert far.region_id == region.pk
    assert extent_of(region) == (7.2, 46.95, 7.4, 47.3)
    client = client_of(a_user(Role.CURATOR))
    client.post("/api/v1/regions/delete", {"import_id": far.pk}, content_type="application/json")
    assert extent_of(region) == (7.2, 47.1, 7.4, 47.3)


def test_a_region_is_as_large_as_before_once_an_import_into_it_is_undone(tmp_path: Path) -> None:
    nodes, ways = small_line()
    region = import_osm(path=write_osm(tmp_path / "line.osm", nodes, ways)).region
    assert region is not None
    before = Region.objects.get().extent.extent
    nodes[5] = (9.019, 47.0, TOWER)
    second = import_osm(path=write_osm(tmp_path / "line2.osm", nodes, ways))
    assert second.region_id == region.pk
    assert Region.objects.get().extent.extent[2] == pytest.approx(9.021)
    with transaction.atomic():
        write_undo(undo_of(second), actor=None)
    assert Region.objects.get().extent.extent == before


def test_a_region_is_deleted_by_a_job_that_tells_its_progress_and_begins_again_after_a_lost_worker() -> None:
    user = a_user(Role.CURATOR)
    client = client_of(user)
    an_import("ohio.osm.pbf", OHIO)
    region = the_demo()
    body = {"region_id": region.pk, "as_job": True}
    answer = client.post("/api/v1/regions/delete", body, content_type="application/json")
    assert answer.status_code == 202
    assert len(regions_in_use()) == 2
    job = Job.objects.get(pk=answer.json()["job"])
    told: list[tuple[str, float]] = []

    def lost(reason: Reason, share: float) -> None:
        told.append((reason.code, share))
        if reason.code == "deleting_rest":
            raise JobLost

    with pytest.raises(JobLost):
        delete_region_of(job=job, progress=lost)
    assert [code for code, _share in told] == ["deleting_zones", "deleting_terrain", "deleting_assets", "deleting_rest"]
    assert [share for _code, share in told] == sorted(share for _code, share in told)
    assert len(regions_in_use()) == 2
    delete_region_task(str(job.pk))
    done = client.get(f"/api/v1/jobs/{job.pk}").json()
    assert (done["state"], done["result"]) == ("done", {"counts": {"tower": 2, "zone": 1, "terrain": 1}})
    assert [row.name for row in regions_in_use()] == ["Ohio"]
    delete_region_task(str(job.pk))


@pytest.mark.parametrize("body", [{"set": "x", "as_job": True}, {"bbox": [0, 0, 1, 1], "as_job": True}])
def test_only_a_region_is_deleted_by_a_job(body: dict[str, Any]) -> None:
    assert client_of(a_user(Role.CURATOR)).post("/api/v1/regions/delete", body, content_type="application/json").status_code == 400
