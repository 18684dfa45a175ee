"""Tracks as KML 2.2 with timed tracks (gx:Track), one Placemark per UAV.

Elements are in the order of the schemas (opengis.net/kml/2.2, google.com/kml/ext/2.2). A track is split into parts of some hundred points,
because all times of a part precede all its positions; only one part is in memory. Records without a position and records from the future
are omitted.
"""

from collections.abc import Callable, Iterable, Iterator

from telemetry.exports.logged_record import LoggedRecord, Value, time_text
from telemetry.exports.xml_text import xml_text

NAMESPACE = "http://www.opengis.net/kml/2.2"
GX_NAMESPACE = "http://www.google.com/kml/ext/2.2"
POINTS_A_PART = 200
ARRAYS: dict[str, Callable[[LoggedRecord], Value]] = {
    "received_at": lambda record: time_text(record.received_at),
    "stored_at": lambda record: time_text(record.stored_at),
    "altitude_amsl_m": lambda record: record.value("altitude_amsl_m"),
    "altitude_relative_m": lambda record: record.value("altitude_relative_m"),
    "altitude_agl_m": lambda record: record.value("altitude_agl_m"),
    "battery_percent": lambda record: record.value("battery_percent"),
}
TEXTS = {"received_at", "stored_at"}


def kml_pieces(records: Iterable[LoggedRecord], *, name: str) -> Iterator[str]:
    """Yield the file. `records` are sorted by UAV, stream and time of measurement."""
    fields = "".join(
        f'<gx:SimpleArrayField name="{field}" type="{"string" if field in TEXTS else "float"}"><displayName>{field}</displayName>'
        "</gx:SimpleArrayField>"
        for field in ARRAYS
    )
    yield (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<kml xmlns="{NAMESPACE}" xmlns:gx="{GX_NAMESPACE}"><Document><name>{xml_text(name)}</name>\n'
        f'<Schema id="report">{fields}</Schema>\n'
    )
    uav: int | None = None
    for part in _parts(records):
        if part[0].uav != uav:
            ending = "" if uav is None else "</gx:MultiTrack></Placemark>\n"
            uav = part[0].uav
            yield f"{ending}<Placemark><name>{xml_text(part[0].uav_name)}</name><gx:MultiTrack><gx:interpolate>1</gx:interpolate>\n"
        yield _track(part)
    yield ("" if uav is None else "</gx:MultiTrack></Placemark>\n") + "</Document></kml>\n"


def _parts(records: Iterable[LoggedRecord]) -> Iterator[list[LoggedRecord]]:
    """Yield runs of one UAV's stream with one height reference; none is empty."""
    part: list[LoggedRecord] = []
    for record in records:
        if not record.is_on_track:
            continue
        if part and (len(part) == POINTS_A_PART or _kind(record) != _kind(part[0])):
            yield part
            part = []
        part.append(record)
    if part:
        yield part


def _kind(record: LoggedRecord) -> tuple[int, str, str]:
    return record.uav, record.stream, _height(record)[0]


def _height(record: LoggedRecord) -> tuple[str, Value]:
    """Return KML's name of the reference, and the height."""
    if (amsl_m := record.value("altitude_amsl_m")) is not None:
        return "absolute", amsl_m
    if (agl_m := record.value("altitude_agl_m")) is not None:
        return "relativeToGround", agl_m
    return "clampToGround", 0.0


def _track(part: list[LoggedRecord]) -> str:
    lines = [f"<gx:Track><altitudeMode>{_height(part[0])[0]}</altitudeMode>"]
    lines.extend(f"<when>{time_text(record.measured_at)}</when>" for record in part)
    lines.extend(_coord(record) for record in part)
    lines.append('<ExtendedData><SchemaData schemaUrl="#report">')
    for name, value_of in ARRAYS.items():
        lines.append(f'<gx:SimpleArrayData name="{name}">')
        lines.extend(f"<gx:value>{'' if (value := value_of(record)) is None else value}</gx:value>" for record in part)
        lines.append("</gx:SimpleArrayData>")
    lines.append("</SchemaData></ExtendedData></gx:Track>\n")
    return "".join(lines)


def _coord(record: LoggedRecord) -> str:
    assert record.position is not None  # noqa: S101 - is_on_track
    longitude, latitude = record.position
    return f"<gx:coord>{longitude:.7f} {latitude:.7f} {_height(record)[1]:.2f}</gx:coord>"
