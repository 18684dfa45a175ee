"""Terrain over HTTP: what there is, the height at a place, the profile along a line, heights in three references, files as proposals."""

import struct
import zipfile
import zlib
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from django.test import Client
from hypothesis import given
from hypothesis import strategies as st

from inspection.models import DataImport, TerrainTile
from inspection.selectors import ground_revision
from inspection.services import import_terrain
from inspection.services.proposals import terrain
from inspection.services.proposals.reading import FileRefused, Provenance, Reading
from inspection.terrain.heights import REFERENCES, UnknownReference, amsl_m, counted_from
from inspection.terrain.profile import MOST_SAMPLES, samples_along
from inspection.terrain.tiff_gate import MOST_BLOCK_BYTES
from tests.inspection.test_terrain_import import geotiff, plane, post
from tests.workspace.people import client_of, somebody
from workspace.models import AuditEntry, Role

METRES = st.floats(-400, 8_800)


@pytest.fixture
def client() -> Client:
    return client_of(somebody(Role.OPERATOR))


def read(path: Path, **parameters: Any) -> Reading:
    origin = Provenance(file_name=path.name)
    return terrain.read(path=path, parameters=parameters, provenance=origin, progress=lambda stage, share: None)


def refusal(path: Path, **parameters: Any) -> str:
    with pytest.raises(FileRefused) as refused:
        read(path, **parameters)
    return str(refused.value)


def hgt(path: Path, height_m: int = 500) -> Path:
    path.write_bytes(np.full((1201, 1201), height_m, dtype=">i2").tobytes())
    return path


@pytest.mark.django_db
def test_models_tell_where_they_reach_how_fine_they_are_and_from_where_they_count(client: Client, tmp_path: Path) -> None:
    assert client.get("/api/v1/terrain").json()["features"] == []
    heights = plane()
    heights[3, 4] = -9999.0
    older = import_terrain(path=geotiff(tmp_path / "older.tif", heights), vertical_datum="EGM2008")
    newer = import_terrain(path=hgt(tmp_path / "N46E009.hgt"))
    features = client.get("/api/v1/terrain").json()["features"]
    assert [feature["id"] for feature in features] == [newer.pk, older.pk]  # what counts on top first
    properties = features[1]["properties"]
    assert (properties["vertical_datum"], properties["voids"]) == ("EGM2008", 1)
    assert properties["resolution_m"] == pytest.approx(111.32, rel=0.01)
    assert features[0]["geometry"]["coordinates"][0][0] == [9.0, 46.0]


@pytest.mark.django_db
def test_the_height_at_a_place_names_its_datum_and_is_null_where_it_is_not_known(client: Client, tmp_path: Path) -> None:
    import_terrain(path=geotiff(tmp_path / "plane.tif", plane()), vertical_datum="EGM2008")
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
    assert found["vertical_datums"] == ["EGM96"]
    assert max(np.diff(found["distance_m"])) <= 100.0


@pytest.mark.django_db
@pytest.mark.parametrize("line", [[], [[9, 47]], [[9, 47], [9, 109]], [[9, 47], [9]], "here"])
def test_a_line_that_is_none_has_no_profile(client: Client, line: Any) -> None:
    assert client.post("/api/v1/terrain/profile", {"line": line}, content_type="application/json").status_code == 400


def test_a_very_long_line_is_looked_at_in_bounded_steps() -> None:
    found = samples_along(np.array([[0.0, 0.0], [90.0, 10.0], [179.0, -10.0]]), 1.0)
    assert len(found.positions) <= MOST_SAMPLES
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
    reading = read(geotiff(tmp_path / "plane.tif", plane()), vertical_datum="EGM2008")
    assert (reading.numbers["new"], reading.summary["vertical_datum"], reading.summary["voids"]) == (6, "EGM2008", 0)
    assert not TerrainTile.objects.exists()
    revision = ground_revision()
    origin = Provenance(file_name="plane.tif", licence="CC0")
    terrain.apply(path=tmp_path / "plane.tif", parameters={}, provenance=origin, applied_by=None, progress=lambda stage, share: None)
    assert (TerrainTile.objects.count(), DataImport.objects.get().licence) == (6, "CC0")
    assert ground_revision() == revision + 1  # missions were planned with other heights
    assert read(tmp_path / "plane.tif").numbers["changed"] == 6


@pytest.mark.django_db
def test_a_zipped_hgt_file_is_taken_and_a_bomb_is_not(tmp_path: Path) -> None:
    path = tmp_path / "tile.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.write(hgt(tmp_path / "N46E009.hgt"), "../../N46E009.hgt")
    assert read(path).summary["posts"] > 1_400_000
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("N46E009.hgt", bytes(200_000_000))
    assert "1201 or 3601" in refusal(path)
    with zipfile.ZipFile(path, "w") as archive:
        for number in range(30):
            archive.writestr(f"{number}.hgt", b"")
    assert "30 members" in refusal(path)


@pytest.mark.django_db
def test_heights_above_the_ellipsoid_are_refused(tmp_path: Path) -> None:
    assert "ellipsoid" in refusal(geotiff(tmp_path / "plane.tif", plane()), vertical_datum="WGS84")


def hostile_tiff(width: int, height: int, rows_per_strip: int) -> bytes:
    """A TIFF whose strips unpack to almost anything from almost nothing."""
    entries = [
        (256, 4, 1, width),
        (257, 4, 1, height),
        (258, 3, 1, 32),
        (259, 3, 1, 8),
        (277, 3, 1, 1),
        (278, 4, 1, rows_per_strip),
        (339, 3, 1, 3),
    ]
    data = zlib.compress(bytes(1_000_000))
    directory = struct.pack("<H", len(entries) + 2)
    offset = 8
    for tag, kind, count, value in [*entries, (273, 4, 1, offset), (279, 4, 1, len(data))]:
        directory += struct.pack("<HHII", tag, kind, count, value)
    return struct.pack("<2sHI", b"II", 42, 8 + len(data)) + data + directory + struct.pack("<I", 0)


@pytest.mark.django_db
@pytest.mark.parametrize(
    ("content", "words"),
    [
        (hostile_tiff(40_000, 4_000, 4_000), f"at most {MOST_BLOCK_BYTES // 2**20} MiB"),
        (hostile_tiff(2_000_000, 2_000_000, 1), "reference system"),
        (b"II*\0\xff\xff\xff\x7f", "cut off"),
        (b"II*\0", "cut off"),
        (b'<VRTDataset rasterXSize="9"><SourceFilename>/etc/passwd</SourceFilename></VRTDataset>', "neither"),
        (b"", "neither"),
    ],
)
def test_a_hostile_terrain_file_is_refused(tmp_path: Path, content: bytes, words: str) -> None:
    path = tmp_path / "heights.tif"
    path.write_bytes(content)
    assert words in refusal(path)
    assert [file.name for file in tmp_path.iterdir()] == ["heights.tif"]


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
    curator = client_of(somebody(Role.CURATOR))
    assert curator.delete(f"/api/v1/terrain/{newer.pk}").status_code == 204
    assert client.get(place).json()["ground_amsl_m"] == 400.0
    assert AuditEntry.objects.get().subject_type == "terrain"
    assert curator.delete(f"/api/v1/terrain/{newer.pk}").status_code == 404
