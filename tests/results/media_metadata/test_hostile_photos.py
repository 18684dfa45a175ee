"""Files that are broken or meant to break something: each is read as far as it can be, or refused by name."""

import io
import struct
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path

import pytest
from PIL import Image

from results.media_metadata.media_types import HEIC, JPEG, MP4, PNG, media_type_of, name_with_suffix
from results.media_metadata.photo_process import ReadingLimits
from tests.results.media_metadata.reading import read, size_of
from tests.results.photos import PACKET, dji_photo, exif_of, file_of, gps_at, picture, xmp_of

LIMITS = ReadingLimits(processor_s=10, answer_s=20.0, max_pixels=4_000_000, max_decoded_bytes=12_000_000)


def png_chunk(kind: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


def png_of_header(width: int, height: int, pixels: bytes = b"") -> bytes:
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + png_chunk(b"IHDR", header) + png_chunk(b"IDAT", zlib.compress(pixels)) + png_chunk(b"IEND", b"")


def zip_behind_jpeg() -> bytes:
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w") as writer:
        writer.writestr("index.html", "<script>alert(1)</script>")
    return dji_photo() + archive.getvalue()


def billion_laughs() -> bytes:
    entities = "".join(f'<!ENTITY a{n} "{f"&a{n - 1};" * 10}">' for n in range(1, 10))
    packet = f'<!DOCTYPE x [<!ENTITY a0 "ha">{entities}]>' + PACKET.format("&a9;")
    return file_of(picture(), exif=exif_of(), xmp=packet.encode())


def with_damaged_exif() -> bytes:
    content = bytearray(file_of(picture(), exif=exif_of(gps=gps_at(10.0, 56.0))))
    at = content.find(b"Exif\0\0") + 14
    content[at : at + 60] = b"\xff" * 60
    return bytes(content)


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        (lambda: png_of_header(60_000, 60_000, bytes(2**20)), "too_many_pixels"),  # 10.8 GB of pixels in some kilobytes
        (lambda: png_of_header(1_999, 2_000, bytes(2_000 * 6_000)), "too_large_to_decode"),
        (lambda: file_of(picture((2_500, 2_500))), "too_many_pixels"),
        (lambda: dji_photo(size=(800, 600))[:-3_000], "truncated"),
        (lambda: dji_photo()[:300], "undecodable"),
        (lambda: b"\xff\xd8\xff" + b"\0" * 5_000, "undecodable"),
        (lambda: b"II*\0" + b"\xff" * 5_000, "undecodable"),
        (lambda: b"RIFF\x10\0\0\0WEBPVP8 " + b"\0" * 100, "undecodable"),
        (lambda: png_of_header(100, 100, b"short"), "truncated"),
        (lambda: b"\0\0\0\x18ftypheic" + b"\0" * 100, "not_decoded"),
        (lambda: b"GIF89a" + b"\0" * 100, "not_decoded"),
        (lambda: b"", "not_decoded"),
    ],
    ids=[
        "bomb", "bomb under the limit of pixels", "too many pixels", "truncated", "header alone", "no JPEG behind its mark", "no TIFF",
        "no WebP", "PNG without its pixels", "HEIC", "GIF", "empty",
    ],
)  # fmt: skip
def test_what_is_not_shown_is_refused_by_name(content: Callable[[], bytes], fault: str, tmp_path: Path) -> None:
    found = read(content(), tmp_path, LIMITS)
    assert found.fault == fault
    assert found.derivatives == {} and list(tmp_path.iterdir()) == []


def test_of_a_truncated_photo_the_metadata_are_read(tmp_path: Path) -> None:
    found = read(dji_photo(size=(800, 600))[:-3_000], tmp_path)
    assert found.record is not None and found.record.position is not None
    assert (found.width_px, found.height_px) == (800, 600)


@pytest.mark.parametrize(
    ("content", "faults"),
    [(zip_behind_jpeg, ()), (billion_laughs, ("xmp",)), (with_damaged_exif, None)],
    ids=["archive behind a photo", "entities in XMP", "damaged EXIF"],
)
def test_what_is_odd_beside_the_pixels_does_no_harm(content: Callable[[], bytes], faults: tuple[str, ...] | None, tmp_path: Path) -> None:
    found = read(content(), tmp_path, LIMITS)
    assert found.fault == "" and set(found.derivatives) == {"400", "1600"}
    assert found.record is not None
    assert faults is None or found.record.faults == faults
    assert b"script" not in (tmp_path / "1600.webp").read_bytes()


def test_the_limits_of_time_and_memory_end_the_reading(tmp_path: Path) -> None:
    large = file_of(picture((3_000, 3_000)), "PNG")
    assert read(large, tmp_path, ReadingLimits(memory_bytes=60 * 2**20)).fault in {"memory", "decoder_failed"}
    assert read(large, tmp_path, ReadingLimits(answer_s=0.001)).fault == "time"


@pytest.mark.parametrize("orientation", range(1, 9))
def test_derivatives_are_upright_once_and_sizes_are_those_of_the_upright_picture(orientation: int, tmp_path: Path) -> None:
    found = read(file_of(picture((2_000, 1_000)), exif=exif_of(orientation=orientation)), tmp_path)
    is_turned = orientation >= 5
    assert (found.width_px, found.height_px) == ((1_000, 2_000) if is_turned else (2_000, 1_000))
    assert size_of(tmp_path / "1600.webp") == found.derivatives["1600"] == ((800, 1_600) if is_turned else (1_600, 800))
    assert size_of(tmp_path / "400.webp") == found.derivatives["400"] == ((200, 400) if is_turned else (400, 200))


def test_derivatives_hold_no_metadata(tmp_path: Path) -> None:
    profile = b"profile of a camera" * 10
    xmp = xmp_of("drone-dji", "http://www.dji.com/drone-dji/1.0/", {"GpsLatitude": "+56.0", "DroneSerialNumber": "1581F"})
    read(file_of(picture(), exif=exif_of(gps=gps_at(10.0, 56.0)), xmp=xmp, icc_profile=profile), tmp_path)
    for edge in ("400", "1600"):
        content = (tmp_path / f"{edge}.webp").read_bytes()
        assert not any(mark in content for mark in (b"Exif", b"EXIF", b"XMP ", b"ICCP", b"1581F", b"DJI"))


@pytest.mark.parametrize(
    ("kind", "mode"),
    [("PNG", "RGBA"), ("PNG", "P"), ("PNG", "I;16"), ("TIFF", "I;16"), ("TIFF", "F"), ("JPEG", "CMYK"), ("JPEG", "L"), ("WEBP", "RGBA")],
)
def test_other_depths_and_colours_are_shown(kind: str, mode: str, tmp_path: Path) -> None:
    image = Image.new(mode, (300, 200), 30_000) if mode == "I;16" else picture((300, 200), mode)
    found = read(file_of(image, kind), tmp_path)
    assert (found.fault, found.derivatives["400"]) == ("", (300, 200))


@pytest.mark.long
def test_a_photo_of_100_megapixels_is_shown_within_the_limits_of_memory(tmp_path: Path) -> None:
    found = read(file_of(picture((14_000, 7_200)), quality=60), tmp_path)
    assert (found.fault, found.derivatives["1600"]) == ("", (1_600, 823))


def test_a_photo_with_a_preview_behind_it_is_shown_as_its_first_picture(tmp_path: Path) -> None:
    """DJI writes such files (CIPA DC-007, MPF)."""
    found = read(file_of(picture((640, 480)), "MPO", save_all=True, append_images=[picture((160, 120))]), tmp_path)
    assert (found.fault, found.width_px, found.derivatives["400"]) == ("", 640, (400, 300))


def test_content_decides_what_a_file_is() -> None:
    assert media_type_of(dji_photo()) is JPEG
    assert media_type_of(file_of(picture(), "PNG")) is PNG
    assert media_type_of(b"\0\0\0\x18ftypmif1") is HEIC
    assert media_type_of(b"\0\0\0\x18ftypisom") is MP4
    for other in (b"<html>", b"%PDF-1.7", b"PK\x03\x04", b"MZ", b"\x7fELF", b"<svg ", b"\0\0\0\x18ftypavif", b""):
        assert media_type_of(other) is None
    assert name_with_suffix("tower.html", JPEG) == "tower.html.jpg"
    assert name_with_suffix("DJI_0001.JPG", JPEG) == "DJI_0001.JPG"
