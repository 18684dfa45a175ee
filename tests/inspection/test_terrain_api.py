"""Terrain over HTTP: what there is, the height at a place, the profile along a line, heights in three references, files as proposals."""

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from django.contrib.gis.geos import GEOSGeometry
from django.test import Client
from hypothesis import given
from hypothesis import strategies as st

from inspection.models import DataImport, NoFlyZone, TerrainTile
from inspection.selectors import ground_revision
from inspection.services import import_terrain
from inspection.services.proposals import terrain
from inspection.services.proposals.reading import FileRefused, Provenance, Reading
from inspection.terrain.heights import MAX_SAMPLES, REFERENCES, UnknownReference, amsl_m, counted_from, samples_along
from tests.accounts.users import a_user, client_of
from tests.inspection.importers.terrain.tiffs import write_hgt
from tests.inspection.imports.test_terrain_import import geotiff, plane, post
from workspace.models import AuditEntry, Role

METRES = st.floats(-400, 8_800)


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.OPERATOR))


def read(path: Path, **parameters: Any) -> Reading:
    origin = Provenance(file_name=path.name)
    return terrain.read(path=path, parameters=parameters, provenance=origin, progress=lambda stage, share: None)


def apply(path: Path, **parameters: Any) -> DataImport:
    origin = Provenance(file_name=path.name, licence="CC0")
    return terrain.apply(path=path, parameters=parameters, provenance=origin, applied_by=None, progress=lambda stage, share: None)


def refusal(path: Path, **parameters: Any) -> str:
    with pytest.raises(FileRefused) as refused:
        read(path, **parameters)
    return str(refused.value)


@pytest.mark.django_db
def test_models_tell_where_they_reach_how_fine_they_are_and_from_where_they_count(client: Client, tmp_path: Path) -> None:
    assert client.get("/api/v1/terrain").json()["features"] == []
    heights = plane()
    heights[3, 4] = -9999.0
    older = import_terrain(path=geotiff(tmp_path / "older.tif", heights, srid=4326), vertical_datum="EGM2008")
    newer = import_terrain(path=write_hgt(tmp_path / "N46E009.hgt", 500))
    features = client.get("/api/v1/terrain").json()["features"]
    assert [feature["id"] for feature in features] == [newer.pk, older.pk]  # what counts on top first
    properties = features[1]["properties"]
    assert (properties["vertical_datum"], properties["voids"]) == ("EGM2008", 1)
    assert properties["resolution_m"] == pytest.approx(111.32, rel=0.01)
    assert (properties["over"], features[0]["properties"]["over"]) == ([], [older.pk])
    assert features[0]["properties"]["other_datums"] == ["EGM2008"]
    assert features[0]["geometry"]["type"] == "Polygon"
    assert sorted(features[0]["geometry"]["coordinates"][0])[0] == [9.0, 46.0]


@pytest.mark.django_db
def test_the_height_at_a_place_names_its_datum_and_is_null_where_it_is_not_known(client: Client, tmp_path: Path) -> None:
    import_terrain(path=geotiff(tmp_path / "plane.tif", plane(), srid=4326), vertical_datum="EGM2008")
    lon, lat = post(100, 200)
    found = client.get(f"/api/v1/terrain/height?position={lon},{lat}").json()
    assert found == {"ground_amsl_m": 400.0, "vertical_datum": "EGM2008", "source": "plane.tif"}
    assert client.get("/api/v1/terrain/height?position=20,20").json() == {"ground_amsl_m": None, "vertical_datum": None, "source": None}


@pytest.mark.django_db
@pytest.mark.parametrize("position", ["", "9", "47,109", "nan,47", "a,b", "1,2,3"])
def test_a_place_that_is_none_is_refused(client: Client, position: str) -> None:
    assert client.get(f"/api/v1/terrain/height?position={position}").status_code == 400


@pytest.mark.django_db
def test_a_profile_follows_the_ground_and_tells_what_it_does_not_know(client: Client, tmp_path: Path) -> None:
    heights = plane()
    heights[:, 300:320] = -9999.0
    import_terrain(path=geotiff(tmp_path / "plane.tif", heights))
    line = [list(post(100, 100)), list(post(400, 100))]
    found = client.post("/api/v1/terrain/profile", {"line": line, "step_m": 100}, content_type="application/json").json()
    assert found["ground_amsl_m"][0] == pytest.approx(375.0, abs=0.01)
    assert found["ground_amsl_m"][-1] == pytest.approx(525.0, abs=0.01)
    assert (found["distance_m"][0], found["distance_m"][-1]) == (0.0, pytest.approx(found["length_m"], abs=0.01))
    assert found["unknown"] == found["ground_amsl_m"].count(None) > 0
    assert (found["vertical_datums"], found["sources"]) == (["EGM96"], ["plane.tif"])
    assert max(np.diff(found["distance_m"])) <= 100.0


@pytest.mark.django_db
def test_a_profile_is_no_finer_than_what_is_known(client: Client, tmp_path: Path) -> None:
    """Posts stand 111 m apart."""
    import_terrain(path=geotiff(tmp_path / "plane.tif", plane()))
    line = [list(post(100, 100)), list(post(100, 200))]
    for step in ({}, {"step_m": 2}):
        found = client.post("/api/v1/terrain/profile", {"line": line, **step}, content_type="application/json").json()
        assert found["step_m"] == pytest.approx(111.32 / 2, rel=0.02)


@pytest.mark.django_db
def test_a_profile_names_the_zones_that_it_crosses_with_their_limits(client: Client) -> None:
    """The line runs east along 47 N; a zone that is open to the south is crossed twice."""
    shape = GEOSGeometry(
        "MULTIPOLYGON (((9.1 46.9, 9.2 46.9, 9.2 47.1, 9.3 47.1, 9.3 46.9, 9.4 46.9, 9.4 47.2, 9.1 47.2, 9.1 46.9)))", srid=4326
    )
    limits = {"lower_limit_m": None, "lower_reference": "", "upper_limit_m": 120.0, "upper_reference": "AGL"}
    zone = NoFlyZone.objects.create(identifier="u", name="Reserve", geometry=shape, **limits)
    NoFlyZone.objects.create(identifier="far", name="Far", geometry=GEOSGeometry("MULTIPOLYGON (((0 0, 1 0, 1 1, 0 0)))", srid=4326))
    found = client.post("/api/v1/terrain/profile", {"line": [[9, 47], [9.15, 47], [9.5, 47]]}, content_type="application/json").json()
    per_degree_m = found["length_m"] / 0.5
    assert [(along["id"], along["from_m"], along["to_m"]) for along in found["zones"]] == [
        (zone.pk, pytest.approx(0.1 * per_degree_m, abs=1), pytest.approx(0.2 * per_degree_m, abs=1)),
        (zone.pk, pytest.approx(0.3 * per_degree_m, abs=1), pytest.approx(0.4 * per_degree_m, abs=1)),
    ]
    assert found["zones"][0]["upper_limit"] == {"value_m": 120.0, "reference": "AGL"}
    assert found["zones"][0]["lower_limit"] is None


@pytest.mark.django_db
def test_a_model_of_several_tiles_covers_what_they_cover(client: Client, tmp_path: Path) -> None:
    heights = plane(900, 300)
    heights[:, 250:700] = -9999.0
    import_terrain(path=geotiff(tmp_path / "gap.tif", heights))
    (feature,) = client.get("/api/v1/terrain").json()["features"]
    assert feature["geometry"]["type"] == "MultiPolygon"
    assert len(feature["geometry"]["coordinates"]) == 2


@pytest.mark.django_db
def test_a_void_is_told_with_the_older_model_that_fills_it(client: Client, tmp_path: Path) -> None:
    import_terrain(path=geotiff(tmp_path / "older.tif", plane(), srid=9518))
    heights = plane(base=900.0)
    heights[95:105, 195:205] = -9999.0
    import_terrain(path=geotiff(tmp_path / "newer.tif", heights))
    lon, lat = post(200, 100)
    found = client.get(f"/api/v1/terrain/height?position={lon},{lat}").json()
    assert found == {"ground_amsl_m": 425.0, "vertical_datum": "EGM2008", "source": "older.tif"}


@pytest.mark.django_db
@pytest.mark.parametrize("line", [[], [[9, 47]], [[9, 47], [9, 109]], [[9, 47], [9]], "here"])
def test_a_line_that_is_none_has_no_profile(client: Client, line: Any) -> None:
    assert client.post("/api/v1/terrain/profile", {"line": line}, content_type="application/json").status_code == 400


def test_a_very_long_line_is_looked_at_in_bounded_steps() -> None:
    found = samples_along(np.array([[0.0, 0.0], [90.0, 10.0], [179.0, -10.0]]), 1.0)
    assert len(found.positions) <= MAX_SAMPLES
    assert any((position == [90.0, 10.0]).all() for position in found.positions)


@given(st.sampled_from(REFERENCES), METRES, METRES, METRES)
def test_a_height_comes_back_from_a_round_through_all_references(
    reference: str, value_m: float, ground_m: float, take_off_m: float
) -> None:
    ground = np.array([ground_m])
    now = np.array([value_m])
    order = [reference, *(other for other in REFERENCES if other != reference), reference]
    for source, target in pairwise(order):
        above_sea = amsl_m(now, source, ground_amsl_m=ground, take_off_amsl_m=take_off_m)
        now = counted_from(above_sea, target, ground_amsl_m=ground, take_off_amsl_m=take_off_m)
    assert now[0] == pytest.approx(value_m, abs=0.1)


def test_what_is_not_known_is_no_number_and_what_has_no_reference_no_height() -> None:
    unknown = np.array([np.nan])
    assert np.isnan(amsl_m(np.array([60.0]), "AGL", ground_amsl_m=unknown, take_off_amsl_m=0.0)).all()
    assert np.isnan(amsl_m(np.array([60.0]), "RELATIVE", ground_amsl_m=np.zeros(1), take_off_amsl_m=float("nan"))).all()
    with pytest.raises(UnknownReference):
        amsl_m(np.array([60.0]), "", ground_amsl_m=np.zeros(1), take_off_amsl_m=0.0)


@pytest.mark.django_db
def test_heights_agree_in_all_references_over_real_posts(client: Client, tmp_path: Path) -> None:
    rough = plane() + np.random.default_rng(5).normal(0, 40, (300, 600)).astype(np.float32)
    import_terrain(path=geotiff(tmp_path / "rough.tif", rough))
    positions = [list(post(column, row)) for column, row in ((10.3, 20.7), (300.5, 150.5), (500.1, 280.9))] + [[20.0, 20.0]]
    agl = [60.0, 35.5, 120.0, 60.0]
    first = _convert(client, positions, agl, "AGL")
    assert first["altitude_amsl_m"][-1] is None  # the ground is not known there
    known = positions[:-1]
    back = _convert(client, known, first["altitude_relative_m"][:-1], "RELATIVE")
    again = _convert(client, known, back["altitude_amsl_m"], "AMSL")
    assert again["altitude_agl_m"] == pytest.approx(agl[:-1], abs=0.1)
    assert first["altitude_relative_m"][0] == pytest.approx(60.0, abs=0.01)


def _convert(client: Client, positions: list[list[float]], heights_m: list[float], reference: str) -> dict[str, Any]:
    body = {"positions": positions, "heights_m": heights_m, "reference": reference}
    answer = client.post("/api/v1/terrain/heights", body, content_type="application/json")
    assert answer.status_code == 200, answer.content
    return answer.json()


@pytest.mark.django_db
def test_a_height_without_a_reference_is_refused(client: Client) -> None:
    body = {"positions": [[9, 47]], "heights_m": [60], "reference": "MSL"}
    assert client.post("/api/v1/terrain/heights", body, content_type="application/json").status_code == 400


@pytest.mark.django_db
def test_a_terrain_file_is_looked_at_before_it_counts(tmp_path: Path) -> None:
    heights = plane()
    heights[3, 4], heights[5, 6] = -9999.0, 99_999.0
    path = geotiff(tmp_path / "plane.tif", heights, srid=4326)
    reading = read(path, vertical_datum="EGM2008")
    summary = reading.summary
    assert (reading.numbers["new"], summary["vertical_datum"], summary["posts"], summary["voids"]) == (6, "EGM2008", 180_000, 2)
    assert "1 of them without being declared" in summary["notes"][0]
    assert not TerrainTile.objects.exists()
    revision = ground_revision()
    apply(path, vertical_datum="EGM2008")
    assert (TerrainTile.objects.count(), DataImport.objects.get().licence) == (6, "CC0")
    assert ground_revision() == revision + 1  # missions were planned with other heights
    assert read(path, vertical_datum="EGM2008").numbers == {"new": 0, "changed": 0, "vanished": 0, "kept": 0, "unchanged": 6}


@pytest.mark.django_db
def test_a_difference_tells_block_by_block_what_the_ground_becomes(tmp_path: Path) -> None:
    apply(geotiff(tmp_path / "plane.tif", plane()))
    raised = plane(width=300)
    raised[100:110, 50:60] += 80.0
    raised[:, 256:] += 5.0
    reading = read(geotiff(tmp_path / "plane.tif", raised))
    changes = tuple(reading.changes)
    assert reading.numbers == {"new": 0, "changed": 3, "vanished": 4, "kept": 0, "unchanged": 1}
    first = next(change for change in changes if change.action == "changed")
    assert first.before and first.after
    assert first.before["model"] == first.after["model"] == "plane.tif"
    assert sorted(change.after["largest_change_m"] for change in changes if change.after) == [5.0, 5.0, 80.0]
    assert first.geometry is not None
    assert first.label.startswith("Block at 46.")
    elsewhere = read(geotiff(tmp_path / "elsewhere.tif", plane(), origin=(20.0, 47.0)))
    assert elsewhere.numbers["new"] == 6


@pytest.mark.django_db
def test_the_same_heights_under_another_name_change_nothing(tmp_path: Path) -> None:
    apply(geotiff(tmp_path / "plane.tif", plane()))
    assert read(geotiff(tmp_path / "again.tif", plane())).numbers == {"new": 0, "changed": 0, "vanished": 0, "kept": 0, "unchanged": 6}


@pytest.mark.django_db
def test_where_two_datums_would_meet_it_is_said(tmp_path: Path) -> None:
    apply(geotiff(tmp_path / "west.tif", plane(), srid=9518))
    notes = read(geotiff(tmp_path / "east.tif", plane(), origin=(9.4, 47.0))).summary["notes"]
    assert notes == ["west.tif here counts its heights from EGM2008, this file from EGM96: where they meet, heights may step."]


@pytest.mark.django_db
def test_a_file_that_does_not_say_from_where_it_counts_asks_for_it(tmp_path: Path) -> None:
    path = geotiff(tmp_path / "plane.tif", plane(), srid=4326)
    with pytest.raises(FileRefused) as refused:
        read(path)
    assert [fault.place for fault in refused.value.faults] == ["vertical_datum"]
    assert read(path, vertical_datum="DHHN2016").summary["vertical_datum"] == "DHHN2016"
    assert read(write_hgt(tmp_path / "N46E009.hgt", 5)).summary["vertical_datum"] == "EGM96"


@pytest.mark.django_db
def test_heights_above_the_ellipsoid_are_refused(tmp_path: Path) -> None:
    assert "ellipsoid" in refusal(geotiff(tmp_path / "plane.tif", plane(), srid=4326), vertical_datum="WGS84")


@pytest.mark.django_db
def test_a_cut_file_is_refused_and_changes_nothing(tmp_path: Path) -> None:
    whole = geotiff(tmp_path / "plane.tif", plane()).read_bytes()
    cut = tmp_path / "cut.tif"
    cut.write_bytes(whole[: len(whole) // 2])
    assert refusal(cut)
    assert not DataImport.objects.exists()


@pytest.mark.django_db
def test_a_model_is_taken_away_by_curators_and_the_older_one_counts_again(client: Client, tmp_path: Path) -> None:
    import_terrain(path=geotiff(tmp_path / "plane.tif", plane()))
    newer = import_terrain(path=geotiff(tmp_path / "higher.tif", plane(base=1_300.0)))
    lon, lat = post(100, 200)
    place = f"/api/v1/terrain/height?position={lon},{lat}"
    assert client.get(place).json()["ground_amsl_m"] == 1_400.0
    assert client.delete(f"/api/v1/terrain/{newer.pk}").status_code == 403
    curator = client_of(a_user(Role.CURATOR))
    assert curator.delete(f"/api/v1/terrain/{newer.pk}").status_code == 204
    assert client.get(place).json()["ground_amsl_m"] == 400.0
    assert AuditEntry.objects.get().subject_type == "terrain"
    assert curator.delete(f"/api/v1/terrain/{newer.pk}").status_code == 404
