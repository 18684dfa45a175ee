"""Photos as CSV (RFC 4180) and GeoJSON (RFC 7946): one row or Feature each, with units and references in the names."""

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from inspection.exporters.text_pieces import cell, collection_pieces, csv_pieces
from telemetry.exports.logged_record import Value, time_text

TIMES = ("taken_at", "received_at")
STORED = (
    "time_source", "time_bound_s", "flight", "waypoint_sequence", "mission_item", "is_taken", "camera", "image_index", "position_source",
    "position_bound_m", "altitude_amsl_m", "altitude_relative_m", "altitude_agl_m", "roll_deg", "pitch_deg", "yaw_deg", "yaw_frame",
    "attitude_source", "file_url",
)  # fmt: skip
COLUMNS = ("id", *TIMES, "uav", "uav_name", "mission", "longitude_deg", "latitude_deg", *STORED)


@dataclass(frozen=True, slots=True)
class CaptureRow:
    """A photo. `values` are those of STORED in their order."""

    id: int
    uav: int
    uav_name: str
    mission: str | None
    taken_at: datetime
    received_at: datetime
    position: tuple[float, float] | None
    values: tuple[Value, ...]


def capture_feature(row: CaptureRow) -> dict[str, Any]:
    """Return the Feature of a photo. Heights are properties, because GeoJSON's third coordinate has another reference."""
    geometry = None if row.position is None else {"type": "Point", "coordinates": list(row.position)}
    properties: dict[str, Any] = {"uav": row.uav, "uav_name": row.uav_name, "mission": row.mission}
    properties |= {"taken_at": time_text(row.taken_at), "received_at": time_text(row.received_at)}
    return {"type": "Feature", "id": row.id, "geometry": geometry, "properties": properties | dict(zip(STORED, row.values, strict=True))}


def captures_geojson(rows: Iterable[CaptureRow]) -> Iterator[str]:
    return collection_pieces(json.dumps(capture_feature(row), separators=(",", ":"), ensure_ascii=False) for row in rows)


def captures_csv(rows: Iterable[CaptureRow]) -> Iterator[str]:
    return csv_pieces(COLUMNS, map(_cells, rows))


def _cells(row: CaptureRow) -> Iterator[Value]:
    yield from (row.id, time_text(row.taken_at), time_text(row.received_at), row.uav, cell(row.uav_name), row.mission)
    yield from row.position or (None, None)
    yield from map(cell, row.values)
