"""Photos as cameras of UAVs write them, made here: their tags follow the makers' documents, their pixels are a ramp."""

import io
from collections.abc import Mapping
from typing import Any

from PIL import Image
from PIL.ExifTags import GPS, IFD, Base

PACKET = '<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">{}</rdf:RDF></x:xmpmeta>'
DJI_NS = "http://www.dji.com/drone-dji/1.0/"


def picture(size: tuple[int, int] = (160, 120), mode: str = "RGB") -> Image.Image:
    ramp = Image.linear_gradient("L").resize(size)
    return ramp.convert(mode)


def file_of(image: Image.Image, kind: str = "JPEG", **options: Any) -> bytes:
    out = io.BytesIO()
    image.save(out, kind, **options)
    return out.getvalue()


def exif_of(
    *,
    make: str = "DJI",
    model: str = "FC6310",
    camera: Mapping[int, Any] | None = None,
    gps: Mapping[int, Any] | None = None,
    orientation: int = 1,
) -> Image.Exif:
    exif = Image.Exif()
    exif[Base.Make], exif[Base.Model], exif[Base.Orientation] = make, model, orientation
    exif.get_ifd(IFD.Exif).update(camera or {})
    exif.get_ifd(IFD.GPSInfo).update(gps or {})
    return exif


def gps_at(lon: float, lat: float, altitude_m: float | None = None, reference: int = 0, **more: Any) -> dict[int, Any]:
    tags: dict[int, Any] = {
        GPS.GPSLatitudeRef: "N" if lat >= 0 else "S", GPS.GPSLatitude: _sexagesimal(lat),
        GPS.GPSLongitudeRef: "E" if lon >= 0 else "W", GPS.GPSLongitude: _sexagesimal(lon),
    }  # fmt: skip
    if altitude_m is not None:
        tags |= {GPS.GPSAltitudeRef: bytes([reference]), GPS.GPSAltitude: altitude_m}
    return tags | {getattr(GPS, name): value for name, value in more.items()}


def _sexagesimal(value: float) -> tuple[float, float, float]:
    degrees, rest = divmod(abs(value) * 3_600.0, 3_600.0)
    minutes, seconds = divmod(rest, 60.0)
    return degrees, minutes, seconds


def taken(at: str, offset: str = "", subseconds: str = "") -> dict[int, str]:
    tags = {Base.DateTimeOriginal: at, Base.OffsetTimeOriginal: offset, Base.SubsecTimeOriginal: subseconds}
    return {int(tag): text for tag, text in tags.items() if text}


def xmp_of(prefix: str, namespace: str, attributes: Mapping[str, str], inner: str = "") -> bytes:
    written = " ".join(f'{prefix}:{name}="{value}"' for name, value in attributes.items())
    return PACKET.format(f'<rdf:Description xmlns:{prefix}="{namespace}" {written}>{inner}</rdf:Description>').encode()


def dji_photo(lon: float = 10.004, lat: float = 56.0, *, size: tuple[int, int] = (160, 120), **more: str) -> bytes:
    """A photo of a DJI camera at a place, 30 m above take-off, that looks north and 45° down."""
    values = {
        "GpsLatitude": f"{lat:+.9f}", "GpsLongitude": f"{lon:+.9f}", "AbsoluteAltitude": "+82.10", "RelativeAltitude": "+30.00",
        "GimbalRollDegree": "+0.00", "GimbalYawDegree": "+0.10", "GimbalPitchDegree": "-45.00",
    } | more  # fmt: skip
    exif = exif_of(camera=taken("2026:06:01 10:00:00", "+02:00"), gps=gps_at(lon, lat, 82.1))
    return file_of(picture(size), exif=exif, xmp=xmp_of("drone-dji", DJI_NS, values))
