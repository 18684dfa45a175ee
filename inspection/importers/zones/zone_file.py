"""A zone file as a whole: its format and its zones, or all of its faults."""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite
from typing import Any

from inspection.geodesy.geometry_validator import GeometryFault, TooMuch
from inspection.importers.rows import MAX_FAULTS, FaultList, TooManyFaults
from inspection.importers.strict_json import JsonFault, can_be_stored, parse_strict_json
from inspection.importers.zones.ed269 import is_ed269, zones_of_ed269
from inspection.importers.zones.ed318 import is_ed318, stated_validity, text_of, zones_of_ed318
from inspection.importers.zones.geojson import zones_of_geojson
from inspection.importers.zones.openair import looks_like_openair, zones_of_openair
from inspection.importers.zones.records import MAX_IDENTIFIER, MAX_NAME, UnreadRecord, ZoneRecord
from operation.reasons import Reason, reason_of

MAX_LOOKED_AT = 20_000  # parts of one zone
_PLACE = re.compile(r"(features|UASZoneList)\[(\d+)\]")
MAX_FILE_BYTES = 32 * 1024 * 1024
_GEOJSON = {"FeatureCollection", "Feature", "Polygon", "MultiPolygon", "Point", "GeometryCollection"}


def unread_of_document(document: dict[str, Any], faults: Sequence[GeometryFault]) -> list[UnreadRecord]:
    """Return one record for each fault inside of a zone; faults of the document itself have none."""
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
    """Yield pairs of numbers that can be longitude and latitude, at any depth of a geometry."""
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


class ZoneFileError(ValueError):
    """Raised for a file that is refused as a whole, with its faults."""

    def __init__(self, faults: list[GeometryFault], *, are_of_records: bool = False) -> None:
        super().__init__("; ".join(str(fault) for fault in faults))
        self.faults = faults
        self.are_of_records = are_of_records  # the file can be read without these records


@dataclass(frozen=True)
class ZoneFile:
    source_format: str
    zone_count: int  # of the file; one zone may have several layers
    zones: list[ZoneRecord]
    provider: str = ""
    valid_from: str | None = None  # as stated, RFC 3339, UTC
    valid_until: str | None = None
    notes: tuple[str | Reason, ...] = ()  # notes for users on how it was read
    unread: tuple[UnreadRecord, ...] = ()


@dataclass
class _ZonesRead:
    source_format: str
    records: list[ZoneRecord]
    provider: str = ""
    validity: tuple[str | None, str | None] = (None, None)
    notes: list[str | Reason] = field(default_factory=list)
    unread: list[UnreadRecord] = field(default_factory=list)


def read_zones(data: bytes, *, leave_out_faulty: bool = False) -> ZoneFile:
    """Return all zones of an ED-269, ED-318, GeoJSON or OpenAir text. Raises ZoneFileError for a file with a fault.

    With leave_out_faulty, faulty records are listed instead, if every fault belongs to one record; files that are too large or of another
    kind are still refused.
    """
    found = FaultList()
    try:
        read = _read_openair(data, found) if looks_like_openair(data) and data.lstrip()[:1] not in {b"{", b"["} else _read_json(data, found)
    except JsonFault as fault:
        raise ZoneFileError([GeometryFault("", reason_of(fault))]) from fault
    except TooManyFaults as many:
        raise ZoneFileError(found.faults) from many
    except GeometryFault as fault:
        found.faults.append(fault)
        raise ZoneFileError(found.faults) from fault
    records = _storable(read, found)
    are_of_records = _are_all_of_records(found.faults, read.unread)
    if found.faults and not (leave_out_faulty and are_of_records):
        raise ZoneFileError(found.faults[:MAX_FAULTS], are_of_records=are_of_records)
    if not records:
        raise ZoneFileError([GeometryFault("", "the file has no zones")])
    return ZoneFile(
        read.source_format,
        sum(record.layer == 0 for record in records),
        _numbered(records),
        read.provider,
        *read.validity,
        tuple(read.notes),
        tuple(read.unread),
    )


def _storable(read: _ZonesRead, found: FaultList) -> list[ZoneRecord]:
    """Return the records that the database can store; the others become unread."""
    kept = []
    for record in read.records:
        fault = _unstorable(record)
        if fault is None:
            kept.append(record)
        else:
            found.faults.append(fault)
            west, south, east, north = record.geometry.bounds
            read.unread.append(UnreadRecord(fault, record.name, record.identifier, (west, south, east, north)))
    return kept


def _are_all_of_records(faults: Sequence[GeometryFault], unread: Sequence[UnreadRecord]) -> bool:
    of_records = {id(record.fault) for record in unread}
    return len(faults) < MAX_FAULTS and all(id(fault) in of_records and not isinstance(fault, TooMuch) for fault in faults)


def _read_openair(data: bytes, faults: FaultList) -> _ZonesRead:
    if len(data) > MAX_FILE_BYTES:
        raise GeometryFault("", f"the file is larger than {MAX_FILE_BYTES // 2**20} MiB")
    notes: list[str | Reason] = []
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("cp1252", errors="replace")
        notes.append("The text is not UTF-8 and was read as Windows-1252.")
    unread: list[UnreadRecord] = []
    zones, more = zones_of_openair(text, faults, unread)
    return _ZonesRead("OpenAir", zones, notes=notes + more, unread=unread)


def _read_json(data: bytes, faults: FaultList) -> _ZonesRead:
    document = parse_strict_json(data, max_bytes=MAX_FILE_BYTES)
    read = _read_document(document, faults)
    read.unread = unread_of_document(document, faults.faults)
    return read


def _read_document(document: Any, faults: FaultList) -> _ZonesRead:
    if is_ed318(document):
        validity = stated_validity(document, faults)
        metadata = document.get("metadata")
        provider = ""
        with faults.gathering():
            provider = text_of(metadata.get("provider"), "metadata.provider", MAX_NAME) if isinstance(metadata, dict) else ""
        notes: list[str] = []
        return _ZonesRead("ED-318", zones_of_ed318(document, faults, notes), provider, validity, [*notes])
    if is_ed269(document):
        return _ZonesRead("ED-269", zones_of_ed269(document, faults))
    if isinstance(document, dict) and isinstance(document.get("type"), str) and document["type"] in _GEOJSON:
        notes = []
        return _ZonesRead("GeoJSON", zones_of_geojson(document, faults, notes), notes=[*notes])
    raise GeometryFault("", "this is neither GeoJSON nor an ED-269, ED-318 or OpenAir file")


def _unstorable(record: ZoneRecord) -> GeometryFault | None:
    """Return the fault of values that JSON allows and the database cannot store."""
    if not can_be_stored([record.properties, record.schedule, record.band.as_stated]):
        return GeometryFault(f"zone {record.identifier}", "its texts have characters that are none")
    return None


def _numbered(records: list[ZoneRecord]) -> list[ZoneRecord]:
    """Return the records with layers counted on where a file uses an identifier for several zones, as national files do."""
    seen: Counter[str] = Counter()
    numbered = []
    for record in records:
        numbered.append(replace(record, layer=seen[record.identifier]))
        seen[record.identifier] += 1
    return numbered
