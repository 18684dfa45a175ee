"""Results of a mission as KML 2.2: folders of targets, incidents, planned and flown lines (gx:Track)."""

from collections.abc import Iterator, Sequence

from inspection.geodesy import LonLat
from telemetry.exports.kml_file import GX_NAMESPACE, NAMESPACE
from telemetry.exports.logged_record import time_text
from telemetry.exports.results import IncidentRow, MissionResults, PlannedPoint, ResultRow, RouteLines, TrackPoint
from telemetry.exports.xml_text import xml_text

STYLES = {"inspected": "ff665d0b", "not-confirmed": "ff0077c7", "not-inspected": "ff1e26b3", "open": "ff827a85"}  # aabbggrr


def results_kml(results: MissionResults, folders: Sequence[str]) -> bytes:
    """Return the file. folders: names for targets, incidents, planned and flown lines, in the reader's language."""
    targets, incidents, planned, flown = folders
    styles = [f'<Style id="{name}"><IconStyle><color>{colour}</color></IconStyle></Style>\n' for name, colour in STYLES.items()]
    parts = [
        '<?xml version="1.0" encoding="UTF-8"?>\n',
        f'<kml xmlns="{NAMESPACE}" xmlns:gx="{GX_NAMESPACE}"><Document><name>{xml_text(results.name)}</name>\n',
        *styles,
        _folder(targets, [_target(row) for row in results.rows if row.position is not None]),
        _folder(incidents, [_incident(one, one.position) for one in results.incidents if one.position is not None]),
        _folder(planned, [_planned(route.uav, route.planned) for route in results.routes if len(route.planned) > 1]),
        _folder(flown, [mark for route in results.routes for mark in _flown(route)]),
        "</Document></kml>\n",
    ]
    return "".join(parts).encode()


def _folder(name: str, marks: Sequence[str]) -> str:
    return f"<Folder><name>{xml_text(name)}</name>\n{''.join(marks)}</Folder>\n" if marks else ""


def _mark(name: str, coordinates: str, description: str, when: str = "", style: str = "") -> str:
    return (
        f"<Placemark><name>{xml_text(name)}</name><description>{xml_text(description)}</description>"
        + (f"<TimeStamp><when>{when}</when></TimeStamp>" if when else "")
        + (f"<styleUrl>#{style}</styleUrl>" if style else "")
        + f"<Point><coordinates>{coordinates}</coordinates></Point></Placemark>\n"
    )


def _incident(one: IncidentRow, position: LonLat) -> str:
    return _mark(one.words, f"{position.lon:.7f},{position.lat:.7f}", one.uav, time_text(one.at))


def _target(row: ResultRow) -> str:
    position = row.position
    assert position is not None  # noqa: S101 - checked by the caller
    words = ". ".join(part for part in (row.line, row.result_words, row.reason, row.uav) if part)
    when = "" if row.reached_at is None else time_text(row.reached_at)
    return _mark(row.asset, f"{position.lon:.7f},{position.lat:.7f}", words, when, row.result)


def _planned(uav: str, points: Sequence[PlannedPoint]) -> str:
    is_high = all(point.altitude_amsl_m is not None for point in points)
    places = " ".join(f"{point.position.lon:.7f},{point.position.lat:.7f},{point.altitude_amsl_m or 0.0:.1f}" for point in points)
    return (
        f"<Placemark><name>{xml_text(uav)}</name><LineString><altitudeMode>{_mode(is_high)}</altitudeMode>"
        f"<coordinates>{places}</coordinates></LineString></Placemark>\n"
    )


def _flown(route: RouteLines) -> Iterator[str]:
    for track in route.flown:
        is_high = all(point.altitude_amsl_m is not None for point in track)
        whens = "".join(f"<when>{time_text(point.at)}</when>" for point in track)
        yield (
            f"<Placemark><name>{xml_text(route.uav)}</name><gx:Track><altitudeMode>{_mode(is_high)}</altitudeMode>"
            f"{whens}{''.join(map(_coordinate, track))}</gx:Track></Placemark>\n"
        )


def _coordinate(point: TrackPoint) -> str:
    return f"<gx:coord>{point.position.lon:.7f} {point.position.lat:.7f} {point.altitude_amsl_m or 0.0:.1f}</gx:coord>"


def _mode(is_high: bool) -> str:
    return "absolute" if is_high else "clampToGround"
