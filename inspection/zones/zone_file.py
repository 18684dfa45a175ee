"""A zone file as a whole: which format it is, its zones, or all that is wrong with it."""

from collections import Counter
from dataclasses import dataclass, replace
from typing import Any

from inspection.zones.ed269 import is_ed269, zones_of_ed269
from inspection.zones.faults import MAX_FAULTS, FaultList, TooManyFaults
from inspection.zones.geojson import zones_of_geojson
from inspection.zones.geometry_gate import GeometryFault
from inspection.zones.records import ZoneRecord
from inspection.zones.strict_json import JsonFault, can_be_stored, parse_strict_json

MAX_FILE_BYTES = 32 * 1024 * 1024
_GEOJSON = {"FeatureCollection", "Feature", "Polygon", "MultiPolygon", "Point", "GeometryCollection"}


class ZoneFileError(ValueError):
    """The file is refused as a whole, for these faults."""

    def __init__(self, faults: list[GeometryFault]) -> None:
        super().__init__("; ".join(str(fault) for fault in faults))
        self.faults = faults


@dataclass(frozen=True)
class ZoneFile:
    source_format: str
    zone_count: int  # of the file; one zone may have several layers
    zones: list[ZoneRecord]


def read_zones(data: bytes) -> ZoneFile:
    """All the zones of an ED-269 or GeoJSON text, or ZoneFileError: none of a file that has a fault."""
    found = FaultList()
    try:
        document = parse_strict_json(data, max_bytes=MAX_FILE_BYTES)
        source_format, records = _zones(document, found)
    except JsonFault as fault:
        raise ZoneFileError([GeometryFault("", str(fault))]) from fault
    except TooManyFaults as many:
        raise ZoneFileError(found.faults) from many
    except GeometryFault as fault:
        found.faults.append(fault)
        raise ZoneFileError(found.faults) from fault
    if not found.faults:
        found.faults = [unstorable for record in records if (unstorable := _unstorable(record))]
    if found.faults:
        raise ZoneFileError(found.faults[:MAX_FAULTS])
    if not records:
        raise ZoneFileError([GeometryFault("", "the file has no zones")])
    return ZoneFile(source_format, sum(record.layer == 0 for record in records), _numbered(records))


def _zones(document: Any, faults: FaultList) -> tuple[str, list[ZoneRecord]]:
    if is_ed269(document):
        return "ED-269", zones_of_ed269(document, faults)
    if isinstance(document, dict) and isinstance(document.get("type"), str) and document["type"] in _GEOJSON:
        return "GeoJSON", zones_of_geojson(document, faults)
    raise GeometryFault("", "this is neither GeoJSON nor an ED-269 document")


def _unstorable(record: ZoneRecord) -> GeometryFault | None:
    """What JSON can write and the database cannot hold."""
    if not can_be_stored([record.properties, record.schedule, record.band.as_stated]):
        return GeometryFault(f"zone {record.identifier}", "its texts have characters that are none")
    return None


def _numbered(records: list[ZoneRecord]) -> list[ZoneRecord]:
    """Layers counted on where a file uses an identifier for several zones, as national files do."""
    seen: Counter[str] = Counter()
    numbered = []
    for record in records:
        numbered.append(replace(record, layer=seen[record.identifier]))
        seen[record.identifier] += 1
    return numbered
