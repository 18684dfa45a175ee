"""Zone files and roll-backs of zone sets as proposals."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from django.contrib.gis.geos import GEOSGeometry, Polygon

from inspection.importers.zones.records import UnreadRecord, ZoneRecord
from inspection.importers.zones.zone_file import ZoneFileError
from inspection.models import ChangeAction, DataImport, ImportKind, NoFlyZone, ZoneSet, ZoneSetVersion
from inspection.services.facts import differing, zone_facts
from inspection.services.imports.regions import join_region
from inspection.services.imports.zone_sets import ZoneDifference, difference_of, key_of, record_facts, records_of_version
from inspection.services.imports.zones import (
    FORMAT_NAMES,
    import_zones,
    make_so,
    read_zone_file,
    refuse_if_elsewhere,
    set_name_of,
    zone_counts,
)
from inspection.services.proposals.reading import Change, Fault, FileRefused, Progress, Provenance, Reading, excluded_of
from operation.reasons import Reason
from workspace.models import User

MIN_DEG = 0.0005
ALL_ELSEWHERE = "say that all of them are to be replaced, or use another name"


def read(*, path: Path | None, parameters: dict[str, Any], provenance: Provenance, progress: Progress) -> Reading:
    """Return the changes of the file, or of the version in the parameters. Raises FileRefused."""
    replace_edited = bool(parameters.get("replace_edited"))
    if path is None:
        version = _version(parameters)
        records, _ = records_of_version(version)
        found = difference_of(version.zone_set, records, replace_edited=True)
        summary = {"set": version.zone_set.name, "version": version.number, "layers": len(records)}
        return Reading(summary, found.numbers, tuple(_changes(found)))
    progress(Reason("reading_zones"), 0.1)
    with _faults_as_refusal():
        content, _ = read_zone_file(path, source_format=_source_format(parameters), leave_out_faulty=_leaves_out(parameters))
        name = set_name_of(path, _set_name(parameters))
        zone_set = ZoneSet.objects.filter(name=name).first()
        if not parameters.get("replace_all"):
            refuse_if_elsewhere(zone_set, content, ALL_ELSEWHERE)
    progress(Reason("comparing"), 0.6)
    found = difference_of(zone_set, content.zones, replace_edited=replace_edited, unread=content.unread)
    numbers = found.numbers | ({ChangeAction.NOT_READ.value: len(content.unread)} if content.unread else {})
    summary = zone_counts(content) | {"set": name, "is_new_set": zone_set is None or not zone_set.zones.exists()}
    summary["by_kind"] = {"zone": found.numbers}
    return Reading(summary, numbers, (*_changes(found), *map(_not_read, content.unread)))


def apply(
    *, path: Path | None, parameters: dict[str, Any], provenance: Provenance, applied_by: User | None, progress: Progress
) -> DataImport:
    """Update the set to the file or the version. Raises FileRefused."""
    progress(Reason("writing_zones"), 0.5)
    if path is None:
        return _roll_back(_version(parameters), applied_by)
    with _faults_as_refusal():
        return import_zones(
            path=path, set_name=set_name_of(path, _set_name(parameters)), imported_by=applied_by,
            replace_edited=bool(parameters.get("replace_edited")), replace_all=bool(parameters.get("replace_all")),
            source_format=_source_format(parameters), leave_out_faulty=_leaves_out(parameters), provenance=provenance,
            excluded=excluded_of(parameters),
        )  # fmt: skip


def _roll_back(version: ZoneSetVersion, actor: User | None) -> DataImport:
    zone_set = version.zone_set
    records, edited = records_of_version(version)
    found = difference_of(zone_set, records, replace_edited=True)
    origin = version.data_import
    data_import = DataImport.objects.create(
        kind=ImportKind.ZONES, file_name=roll_back_name(version), sha256=origin.sha256 if origin else "",
        attribution=origin.attribution if origin else "", licence=origin.licence if origin else "", imported_by=actor,
        source_address=origin.source_address if origin else "", fetched_at=origin.fetched_at if origin else None,
        valid_from=origin.valid_from if origin else None, valid_until=origin.valid_until if origin else None,
        is_synthetic=bool(origin and origin.is_synthetic), counts=found.numbers | {"layers": len(records)},
    )  # fmt: skip
    make_so(zone_set, found, data_import=data_import, actor=actor, edited=edited)
    ZoneSet.objects.filter(pk=zone_set.pk).update(data_import=data_import)
    join_region(data_import)
    return data_import


def roll_back_name(version: ZoneSetVersion) -> str:
    """Return what is shown in place of a file's name."""
    return f"{version.zone_set.name[:220]}, version {version.number}"


def _version(parameters: dict[str, Any]) -> ZoneSetVersion:
    zone_set, number = parameters.get("set"), parameters.get("version")
    version = None
    if isinstance(zone_set, int) and isinstance(number, int) and max(zone_set, number) < 2**31:
        versions = ZoneSetVersion.objects.select_related("zone_set", "data_import")
        version = versions.filter(zone_set=zone_set, number=number).first()
    if version is None:
        raise FileRefused([Fault("version", "there is no such version of the set")])
    return version


def _set_name(parameters: dict[str, Any]) -> str | None:
    name = parameters.get("set_name")
    if name is None or (isinstance(name, str) and name.strip()):
        return name and name.strip()
    raise FileRefused([Fault("set_name", "the name of the set is a text")])


def _leaves_out(parameters: dict[str, Any]) -> bool:
    return parameters.get("leave_out_faulty") is True


def _source_format(parameters: dict[str, Any]) -> str:
    stated = parameters.get("format") or ""
    if stated and (not isinstance(stated, str) or stated not in FORMAT_NAMES):
        raise FileRefused([Fault("format", f"known formats are {', '.join(FORMAT_NAMES)}")])
    return stated


@contextmanager
def _faults_as_refusal() -> Iterator[None]:
    try:
        yield
    except ZoneFileError as error:
        faults = (
            Fault(fault.place, fault.why, (fault.position.lon, fault.position.lat) if fault.position else None) for fault in error.faults
        )
        raise FileRefused(faults, are_of_records=error.are_of_records) from error


def _changes(found: ZoneDifference) -> Iterator[Change]:
    for record in found.new:
        yield Change(
            ChangeAction.NEW, "zone", _label(record), geometry=_drawn(record), after=_shown(record_facts(record)), key=key_of(record)
        )
    for zone, record in found.changed:
        before, after = _differing(zone, record)
        yield Change(ChangeAction.CHANGED, "zone", _label(record), zone.pk, _drawn(record), before, after, key_of(zone))
    for zone in found.vanished:
        shown = _shown(zone_facts(zone))
        yield Change(ChangeAction.VANISHED, "zone", _label(zone), zone.pk, zone.geometry, before=shown, key=key_of(zone))
    for zone, kept in found.kept:
        yield _kept(zone, kept)


def _not_read(record: UnreadRecord) -> Change:
    """Return the place of a record with a fault: the box of its readable positions, at least some metres wide."""
    box = None
    if record.bbox is not None:
        west, south, east, north = record.bbox
        box = Polygon.from_bbox((west - MIN_DEG, south - MIN_DEG, east + MIN_DEG, north + MIN_DEG))
        box.srid = 4326
    after = {"fault": record.fault.message, "place": record.fault.place}
    return Change(ChangeAction.NOT_READ, "zone", record.name or record.fault.place, geometry=box, after=after)


def _kept(zone: NoFlyZone, record: ZoneRecord | None) -> Change:
    if record is None:
        return Change(ChangeAction.KEPT, "zone", _label(zone), zone.pk, zone.geometry, before=_shown(zone_facts(zone)), key=key_of(zone))
    before, after = _differing(zone, record)
    return Change(ChangeAction.KEPT, "zone", _label(zone), zone.pk, zone.geometry, before, after, key_of(zone))


def _differing(zone: NoFlyZone, record: ZoneRecord) -> tuple[dict[str, Any] | None, dict[str, Any] | None]:
    """Return the facts that differ; of the source's further ones, its own keys that differ."""
    facts, other = zone_facts(zone), record_facts(record)
    before, after = differing(_shown(facts), _shown(other))
    for name in ("source_heights", "properties"):
        old, new = facts[name] or {}, other[name] or {}
        keys = [key for key in {**old, **new} if key not in old or key not in new or old[key] != new[key]]
        if keys and before is not None and after is not None:
            before[name] = {key: old[key] for key in keys if key in old}
            after[name] = {key: new[key] for key in keys if key in new}
    return before, after


def _shown(facts: dict[str, Any]) -> dict[str, Any]:
    """Return the facts without those for programs only; a changed geometry is shown on the map."""
    return {name: value for name, value in facts.items() if name not in {"source_heights", "properties", "zone_set_id", "is_edited"}}


def _label(zone: NoFlyZone | ZoneRecord) -> str:
    return zone.name if zone.layer == 0 else f"{zone.name}, layer {zone.layer + 1}"


def _drawn(record: ZoneRecord) -> GEOSGeometry:
    return GEOSGeometry(memoryview(record.geometry.wkb), srid=4326)
