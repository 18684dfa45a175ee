"""Results of a mission as GeoJSON (RFC 7946): targets, incidents, photos, planned and flown lines."""

import json
from collections.abc import Iterator
from typing import Any

from inspection.geodesy import LonLat
from telemetry.exports.captures import CaptureRow, capture_feature
from telemetry.exports.logged_record import time_text
from telemetry.exports.results import MissionResults, RouteLines
from telemetry.exports.results_table import COLUMNS

_PLACES = {"longitude_deg", "latitude_deg"}


def results_geojson(results: MissionResults) -> bytes:
    """Return the file. `kind` of a feature is target, incident, photo, planned or flown.

    A height is a property, because GeoJSON's third coordinate has another reference. A line has `times` and `altitudes_relative_m` with an
    entry for each of its points.
    """
    lines = (feature for route in results.routes for feature in _lines(route))
    features = [*_targets(results), *_incidents(results), *map(_photo, results.photos), *lines]
    return json.dumps({"type": "FeatureCollection", "name": results.name, "features": features}, ensure_ascii=False, default=str).encode()


def _feature(kind: str, geometry: dict[str, Any] | None, properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "Feature", "geometry": geometry, "properties": {"kind": kind, **properties}}


def _point(position: LonLat | None) -> dict[str, Any] | None:
    return None if position is None else {"type": "Point", "coordinates": list(position)}


def _line(points: list[LonLat]) -> dict[str, Any]:
    return {"type": "LineString", "coordinates": [list(point) for point in points]}


def _targets(results: MissionResults) -> Iterator[dict[str, Any]]:
    for row in results.rows:
        properties = {name: read(row) for name, read in COLUMNS.items() if name not in _PLACES}
        for name in ("reason_at", "reached_at"):
            moment = getattr(row, name)
            properties[name] = None if moment is None else time_text(moment)
        yield _feature("target", _point(row.position), properties)


def _incidents(results: MissionResults) -> Iterator[dict[str, Any]]:
    for one in results.incidents:
        yield _feature("incident", _point(one.position), {"at": time_text(one.at), "uav": one.uav, "words": one.words})


def _photo(row: CaptureRow) -> dict[str, Any]:
    feature = capture_feature(row)
    return _feature("photo", feature["geometry"], feature["properties"])


def _lines(route: RouteLines) -> Iterator[dict[str, Any]]:
    if len(route.planned) > 1:
        planned_heights = [point.altitude_relative_m for point in route.planned]
        facts: dict[str, Any] = {"uav": route.uav, "altitudes_relative_m": planned_heights}
        yield _feature("planned", _line([point.position for point in route.planned]), facts)
    for track in route.flown:
        times, heights = [time_text(point.at) for point in track], [point.altitude_relative_m for point in track]
        facts = {"uav": route.uav, "times": times, "altitudes_relative_m": heights}
        yield _feature("flown", _line([point.position for point in track]), facts)
