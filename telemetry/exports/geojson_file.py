"""Records as GeoJSON (RFC 7946), one Feature each."""

import json
from collections.abc import Iterable, Iterator
from typing import Any

from inspection.exporters.text_pieces import collection_pieces
from telemetry.exports.logged_record import FLAGS, REPORTED, LoggedRecord, time_text


def record_feature(record: LoggedRecord) -> dict[str, Any]:
    """Return the Feature of a record. Geometry is null without a position.

    A height is a property, because GeoJSON's third coordinate has another reference.
    """
    geometry = {"type": "Point", "coordinates": list(record.position)} if record.position else None
    properties = {
        "uav": record.uav,
        "uav_name": record.uav_name,
        "mission": record.mission,
        "stream": record.stream,
        "sequence": record.sequence,
        "measured_at": time_text(record.measured_at),
        "received_at": time_text(record.received_at),
        "stored_at": time_text(record.stored_at),
        **dict(zip((*REPORTED, *FLAGS), record.values, strict=True)),
    }
    return {"type": "Feature", "id": record.id, "geometry": geometry, "properties": properties}


def geojson_of_records(records: Iterable[LoggedRecord]) -> Iterator[str]:
    return collection_pieces(json.dumps(record_feature(record), separators=(",", ":"), ensure_ascii=False) for record in records)
