"""What can be told of a zone of a JSON document that has a fault: its name, and where the positions lie that can be read."""

import re
from collections.abc import Iterator, Sequence
from math import isfinite
from typing import Any

from inspection.geodesy.geometry_validator import GeometryFault
from inspection.importers.zones.records import UnreadRecord
from inspection.importers.zones.texts import MAX_IDENTIFIER, MAX_NAME

MAX_LOOKED_AT = 20_000  # parts of one zone
_PLACE = re.compile(r"(features|UASZoneList)\[(\d+)\]")


def unread_of_document(document: dict[str, Any], faults: Sequence[GeometryFault]) -> list[UnreadRecord]:
    """One for each fault that lies in a zone; a fault of the document itself has none."""
    found = []
    for fault in faults:
        place = _PLACE.match(fault.place)
        if place is not None:
            found.append(_unread(document[place[1]][int(place[2])], fault))
    return found


def _unread(zone: Any, fault: GeometryFault) -> UnreadRecord:
    if not isinstance(zone, dict):
        return UnreadRecord(fault)
    properties = zone.get("properties")
    holders = [zone, *([properties] if isinstance(properties, dict) else [])]
    identifier = _text(holders, ("identifier", "id"))[:MAX_IDENTIFIER]
    name = _text(holders, ("name", "Name", "title"))[:MAX_NAME]
    positions = list(_positions(zone.get("geometry")))
    bbox = None
    if positions:
        lons, lats = zip(*positions, strict=True)
        bbox = (min(lons), min(lats), max(lons), max(lats)) if max(lons) - min(lons) <= 180.0 else None
    return UnreadRecord(fault, name or identifier, identifier or name[:MAX_IDENTIFIER], bbox)


def _text(holders: Sequence[dict[str, Any]], keys: Sequence[str]) -> str:
    return next((str(holder[key]) for holder in holders for key in keys if isinstance(holder.get(key), str) and holder[key]), "")


def _positions(geometry: Any) -> Iterator[tuple[float, float]]:
    """Pairs of numbers that can be longitude and latitude, wherever they stand in a geometry."""
    waiting = [geometry]
    for _ in range(MAX_LOOKED_AT):
        if not waiting:
            return
        part = waiting.pop()
        if isinstance(part, dict):
            waiting += part.values()
        elif isinstance(part, list) and len(part) >= 2 and all(_is_number(value) for value in part[:2]):
            if abs(part[0]) <= 180.0 and abs(part[1]) <= 90.0:
                yield float(part[0]), float(part[1])
        elif isinstance(part, list):
            waiting += part


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)
