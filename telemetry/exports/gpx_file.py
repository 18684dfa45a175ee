"""Tracks as GPX 1.1: one track per UAV, one segment per stream, with measured times and heights AMSL.

Elements are in the order of the schema (topografix.com/GPX/1/1/gpx.xsd). Values without a GPX element are in `extensions`, under their
names in the log. Records without a position and records from the future are omitted.
"""

from collections.abc import Iterable, Iterator

from telemetry.exports.logged_record import REPORTED, LoggedRecord, Value, time_text
from telemetry.exports.xml_text import xml_text

NAMESPACE = "http://www.topografix.com/GPX/1/1"
OWN_NAMESPACE = "urn:spanwise:telemetry:1"
POINTS_A_PIECE = 200
MAX_HDOP = 99.0  # sent by receivers without a value
FIXES = {0: "none", 1: "none", 2: "2d", 3: "3d", 4: "dgps"}  # GPS_FIX_TYPE; GPX has no name for better ones
OUTSIDE_EXTENSIONS = {"altitude_amsl_m", "satellites", "hdop"}


def gpx_pieces(records: Iterable[LoggedRecord], *, name: str) -> Iterator[str]:
    """Yield the file. `records` are sorted by UAV, stream and time of measurement."""
    yield (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<gpx xmlns="{NAMESPACE}" xmlns:spanwise="{OWN_NAMESPACE}" version="1.1" creator="Spanwise">\n'
        f"<metadata><name>{xml_text(name)}</name></metadata>\n"
    )
    written: list[str] = []
    uav: int | None = None
    stream: str | None = None
    for record in records:
        if not record.is_on_track:
            continue
        if record.uav != uav:
            written.append(("" if uav is None else "</trkseg></trk>\n") + f"<trk><name>{xml_text(record.uav_name)}</name><trkseg>\n")
        elif record.stream != stream:
            written.append("</trkseg><trkseg>\n")
        uav, stream = record.uav, record.stream
        written.append(_point(record))
        if len(written) >= POINTS_A_PIECE:
            yield "".join(written)
            written.clear()
    yield "".join(written) + ("" if uav is None else "</trkseg></trk>\n") + "</gpx>\n"


def _point(record: LoggedRecord) -> str:
    assert record.position is not None  # noqa: S101 - is_on_track
    longitude, latitude = record.position
    amsl_m, fix, satellites, hdop = (record.value(name) for name in ("altitude_amsl_m", "gps_fix", "satellites", "hdop"))
    parts = [f'<trkpt lat="{latitude:.7f}" lon="{longitude:.7f}">']
    if isinstance(amsl_m, float):
        parts.append(f"<ele>{amsl_m:.2f}</ele>")
    parts.append(f"<time>{time_text(record.measured_at)}</time>")
    if isinstance(fix, int) and fix in FIXES:
        parts.append(f"<fix>{FIXES[fix]}</fix>")
    if satellites is not None:
        parts.append(f"<sat>{satellites}</sat>")
    if isinstance(hdop, float) and hdop < MAX_HDOP:
        parts.append(f"<hdop>{hdop:.2f}</hdop>")
    own: list[tuple[str, Value]] = [
        ("received_at", time_text(record.received_at)),
        ("stored_at", time_text(record.stored_at)),
        *((name, record.value(name)) for name in REPORTED if name not in OUTSIDE_EXTENSIONS),
    ]
    parts.append("<extensions>")
    parts.extend(f"<spanwise:{name}>{_text(value)}</spanwise:{name}>" for name, value in own if value not in (None, ""))
    parts.append("</extensions></trkpt>\n")
    return "".join(parts)


def _text(value: Value) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return xml_text(str(value))
