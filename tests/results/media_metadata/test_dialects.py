"""Each maker's tags become the same record."""

from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path
from typing import Any

import pytest
from PIL import Image
from PIL.ExifTags import GPS

from results.media_metadata.dialects import attitude_of_body
from results.media_metadata.record import CameraHeightReference, Height, TimeSource, record_from_json, record_to_json
from tests.results.media_metadata.reading import record
from tests.results.photos import DJI_NS, dji_photo, exif_of, file_of, gps_at, picture, taken, xmp_of

LON, LAT = -83.0046, 39.9612
PLUS_2_H = timezone(timedelta(hours=2))
PIX4D_NS = "http://pix4d.com/camera/1.0/"


def photo(exif: Image.Exif, xmp: bytes = b"") -> bytes:
    return file_of(picture(), exif=exif, **({"xmp": xmp} if xmp else {}))


def test_dji_states_position_heights_and_gimbal(tmp_path: Path) -> None:
    found = record(dji_photo(LON, LAT, UTCAtExposure="2026-06-01T08:00:00.250"), tmp_path)
    assert found.position is not None and found.attitude is not None
    assert (found.position.lon, found.position.lat, found.position.source) == (LON, LAT, "drone-dji")
    assert [(height.value_m, height.reference) for height in found.heights] == [
        (82.1, CameraHeightReference.AMSL), (30.0, CameraHeightReference.TAKE_OFF), (pytest.approx(82.1), CameraHeightReference.UNKNOWN)
    ]  # fmt: skip
    assert (found.attitude.yaw_deg, found.attitude.pitch_deg, found.attitude.roll_deg) == (0.1, -45.0, 0.0)
    assert (found.taken_at, found.time_source) == (datetime(2026, 6, 1, 8, 0, 0, 250_000, UTC), TimeSource.GPS)
    assert found.taken_local == datetime(2026, 6, 1, 10)
    assert (found.camera_make, found.camera_model) == ("DJI", "FC6310")


def test_a_misspelt_longitude_is_read(tmp_path: Path) -> None:
    xmp = xmp_of("drone-dji", DJI_NS, {"GpsLatitude": str(LAT), "GpsLongtitude": str(LON)})
    found = record(photo(exif_of(), xmp), tmp_path).position
    assert found is not None and (found.lon, found.lat) == (LON, LAT)


@pytest.mark.parametrize("tag", [{"RtkFlag": "50"}, {"AltitudeType": "RtkAlt"}])
def test_with_rtk_the_reference_of_djis_absolute_height_is_unknown(tag: dict[str, str], tmp_path: Path) -> None:
    found = record(dji_photo(**tag), tmp_path)
    assert found.heights[0] == Height(82.1, CameraHeightReference.UNKNOWN, "drone-dji:AbsoluteAltitude")
    assert found.heights[1].reference == CameraHeightReference.TAKE_OFF


def test_parrot_states_the_camera_against_the_horizon(tmp_path: Path) -> None:
    angles = {"CameraYawDegree": "-90.5", "CameraPitchDegree": "-15.25", "CameraRollDegree": "0.5"}
    xmp = xmp_of("drone-parrot", "http://www.parrot.com/drone-parrot/1.0", angles)
    found = record(photo(exif_of(make="Parrot", model="Anafi", gps=gps_at(LON, LAT, 250.0)), xmp), tmp_path)
    assert found.attitude is not None and found.position is not None
    assert (found.attitude.yaw_deg, found.attitude.pitch_deg, found.attitude.source) == (269.5, -15.25, "drone-parrot")
    assert (found.position.lon, found.position.lat) == (pytest.approx(LON, abs=1e-7), pytest.approx(LAT, abs=1e-7))
    assert found.heights == (Height(250.0, CameraHeightReference.AMSL, "exif:GPSAltitude"),)


def test_anafi_ai_writes_heights_above_the_ellipsoid(tmp_path: Path) -> None:
    found = record(photo(exif_of(make="Parrot", model="ANAFI Ai", gps=gps_at(LON, LAT, 216.0))), tmp_path)
    assert [height.reference for height in found.heights] == [CameraHeightReference.ELLIPSOID]


def test_skydio_states_structures(tmp_path: Path) -> None:
    inner = (
        '<drone-skydio:CameraOrientationNED rdf:parseType="Resource"><drone-skydio:Pitch>-30.5</drone-skydio:Pitch>'
        "<drone-skydio:Roll>1</drone-skydio:Roll><drone-skydio:Yaw>-10</drone-skydio:Yaw></drone-skydio:CameraOrientationNED>"
    )
    values = {"Latitude": str(LAT), "Longitude": str(LON), "AbsoluteAltitude": "240.5", "RelativeAltitude": "12"}
    xmp = xmp_of("drone-skydio", "https://www.skydio.com/drone-skydio/1.0/", values, inner)
    found = record(photo(exif_of(make="Skydio", model="X10"), xmp), tmp_path)
    assert found.attitude is not None and found.position is not None
    assert (found.attitude.yaw_deg, found.attitude.pitch_deg, found.attitude.roll_deg) == (350.0, -30.5, 1.0)
    assert [(height.value_m, height.reference) for height in found.heights] == [
        (240.5, CameraHeightReference.AMSL), (12.0, CameraHeightReference.TAKE_OFF)
    ]  # fmt: skip


def test_autels_newer_firmware_writes_as_dji_under_another_prefix(tmp_path: Path) -> None:
    values = {"GimbalYawDegree": "12", "GimbalPitchDegree": "-90", "GimbalRollDegree": "0", "RelativeAltitude": "40"}
    found = record(photo(exif_of(make="Autel Robotics", model="XT709"), xmp_of("drone", DJI_NS, values)), tmp_path)
    assert found.attitude is not None
    assert (found.attitude.yaw_deg, found.attitude.pitch_deg) == (12.0, -90.0)


def test_autels_older_firmware_counts_pitch_from_straight_down_and_leaves_its_height_unknown(tmp_path: Path) -> None:
    xmp = xmp_of("Camera", "http://pix4d.com/camera/1.0", {"Yaw": "20", "Pitch": "60", "Roll": "0"})
    found = record(photo(exif_of(make="Autel Robotics", gps=gps_at(LON, LAT, 300.0)), xmp), tmp_path)
    assert found.attitude is not None
    assert (found.attitude.yaw_deg, found.attitude.pitch_deg) == (pytest.approx(20.0), pytest.approx(-30.0))
    assert [height.reference for height in found.heights] == [CameraHeightReference.UNKNOWN]


def test_sensefly_counts_pitch_from_straight_down(tmp_path: Path) -> None:
    xmp = xmp_of("Camera", PIX4D_NS, {"Yaw": "185.2", "Pitch": "0", "Roll": "0"})
    found = record(photo(exif_of(make="SenseFly", model="S.O.D.A.", gps=gps_at(LON, LAT, 310.0)), xmp), tmp_path)
    assert found.attitude is not None
    assert (found.attitude.yaw_deg, found.attitude.pitch_deg, found.attitude.source) == (pytest.approx(185.2), -90.0, "Camera")


@pytest.mark.parametrize(
    ("body", "camera"),
    [
        ((0.0, 90.0, 0.0), (0.0, 0.0, 0.0)),  # nose up: it looks ahead
        ((90.0, 45.0, 0.0), (90.0, -45.0, 0.0)),
        ((0.0, 0.0, 30.0), (270.0, -60.0, -90.0)),  # right wing down: it looks to the left, and ahead is to the right
    ],
)
def test_a_bodys_angles_become_those_of_the_optical_axis(body: tuple[float, float, float], camera: tuple[float, float, float]) -> None:
    found = attitude_of_body(*body, source="Camera")
    assert (found.yaw_deg, found.pitch_deg) == (pytest.approx(camera[0], abs=1e-9), pytest.approx(camera[1]))
    assert abs(found.roll_deg) == pytest.approx(abs(camera[2]), abs=1e-9)


@pytest.mark.parametrize(
    ("reference", "value_m", "above"), [(0, 12.0, "amsl"), (1, -12.0, "amsl"), (2, 12.0, "ellipsoid"), (3, -12.0, "ellipsoid")]
)
def test_exif_says_what_its_height_is_above_and_whether_it_is_below(reference: int, value_m: float, above: str, tmp_path: Path) -> None:
    found = record(photo(exif_of(make="senseFly", gps=gps_at(LON, LAT, 12.0, reference))), tmp_path)
    assert found.heights == (Height(value_m, CameraHeightReference(above), "exif:GPSAltitude"),)


@pytest.mark.parametrize(
    ("camera", "gps", "expected"),
    [
        (taken("2026:06:01 10:00:00", "+02:00", "5"), {}, (datetime(2026, 6, 1, 10, 0, 0, 500_000, PLUS_2_H), "camera")),
        (taken("2026:06:01 10:00:00"), {}, (None, "local")),
        (taken("2026:06:01 10:00:00"), {"GPSDateStamp": "2026:06:01", "GPSTimeStamp": (8.0, 0.0, 3.0)},
         (datetime(2026, 6, 1, 8, 0, 3, tzinfo=UTC), "gps")),
        (taken("0000:00:00 00:00:00"), {"GPSDateStamp": "", "GPSTimeStamp": (0.0, 0.0, 0.0)}, (None, None)),
        (taken("2026:06:01 10:00:00", "+99:99"), {}, (None, "local")),
    ],
)  # fmt: skip
def test_a_time_has_a_source_and_a_zone_or_none(camera: dict[int, Any], gps: dict[str, Any], expected: Any, tmp_path: Path) -> None:
    found = record(photo(exif_of(camera=camera, gps=gps_at(LON, LAT, **gps))), tmp_path)
    assert (found.taken_at, found.time_source) == expected


@pytest.mark.parametrize(
    "gps",
    [
        gps_at(0.0, 0.0),
        gps_at(LON, LAT, GPSStatus="V"),
        {GPS.GPSLatitude: (1.0, 2.0, 3.0)},
        {GPS.GPSLatitudeRef: "N", GPS.GPSLongitudeRef: "E", GPS.GPSLatitude: (95.0, 0.0, 0.0), GPS.GPSLongitude: (1.0, 0.0, 0.0)},
    ],
    ids=["0, 0", "no fix", "half", "beyond the pole"],
)
def test_a_receiver_without_a_fix_states_no_position(gps: dict[int, Any], tmp_path: Path) -> None:
    assert record(photo(exif_of(gps=gps)), tmp_path).position is None


def test_a_record_comes_back_from_json(tmp_path: Path) -> None:
    found = record(dji_photo(UTCAtExposure="2026-06-01T08:00:00", DroneSerialNumber="1581F"), tmp_path)
    assert record_from_json(record_to_json(found)) == found
    assert found.serial_numbers == {"uav": "1581F"}


def test_thermal_cameras_are_told(tmp_path: Path) -> None:
    assert record(dji_photo(ImageSource="InfraredCamera"), tmp_path).is_thermal
    assert not record(dji_photo(ImageSource="ZoomCamera"), tmp_path).is_thermal
