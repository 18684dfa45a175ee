"""Mapping of an asset file's columns to asset fields, as chosen by a user, and the assets of its rows."""

import hashlib
import json
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from inspection.geodesy import path_length_m
from inspection.geodesy.geometry_validator import GeometryFault
from inspection.importers.assets.asset_file import Row, RowFaults, Shape
from inspection.importers.assets.delimited import number_of
from inspection.importers.osm.tags import CABLE_KINDS, MAX_HEIGHT_M, RAILWAYS_OUT_OF_USE, circuits, length_m, voltages_v
from inspection.importers.rows import Cell, refused

RECORD_VERSION = 1  # incremented when record rules change, so that the next import refreshes the rows
KINDS = ("tower", "line", "railway", "bridge")
BY_GEOMETRY = "by_geometry"  # points are towers, lines are power lines, areas are bridges
ROLES = ("name", "ref", "operator", "voltage", "circuits", "height", "subtype", "key", "external_id")
UNITS = {"height": ("m", "ft"), "voltage": ("V", "kV")}
MAX_KEY = 180
MAX_EXTERNAL_ID = 200  # as in workspace
_KIND_OF_SHAPE = {"Point": "tower", "LineString": "line", "MultiLineString": "line", "MultiPolygon": "bridge"}
_SHAPES = {
    "tower": {"Point"},
    "line": {"LineString", "MultiLineString"},
    "railway": {"LineString", "MultiLineString"},
    "bridge": {"MultiPolygon"},
}
_WORDS = {"Point": "a point", "LineString": "a line", "MultiLineString": "a line", "MultiPolygon": "an area"}
_DRAWN = {"tower": "a point", "line": "a line", "railway": "a line", "bridge": "an area"}
_SUBTYPES = {"tower": "tower", "line": "line", "railway": "rail", "bridge": "area"}


@dataclass(frozen=True)
class Mapping:
    """A mapping. kind is one of KINDS or BY_GEOMETRY; or kind_column with the meaning of its values, "" for rows to skip."""

    kind: str = ""
    kind_column: str = ""
    kinds: dict[str, str] = field(default_factory=dict)
    columns: dict[str, str] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)

    def kind_of(self, row: Row, shape: Shape) -> str | None:
        """Return the row's kind; None if its value has no meaning assigned; "" to skip the row."""
        if self.kind == BY_GEOMETRY:
            return _KIND_OF_SHAPE[shape.geom_type]
        if self.kind:
            return self.kind
        return self.kinds.get(_text(row.properties.get(self.kind_column)))


@dataclass(frozen=True)
class AssetRecord:
    """An asset as the file describes it. source_key identifies it within its set, equally in each file of the source. external_id is the

    sender's id, not a fact about the asset; empty: none.
    """

    kind: str
    subtype: str
    source_key: str
    geometry: BaseGeometry
    name: str
    ref: str
    operator: str
    voltages_v: tuple[int, ...]
    circuits: int | None
    height_m: float | None
    length_m: float | None
    is_flyable: bool
    tags: dict[str, str]
    external_id: str = ""

    @property
    def content_hash(self) -> str:
        facts = [
            RECORD_VERSION, self.kind, self.subtype, self.geometry.wkb_hex, self.name, self.ref, self.operator, self.voltages_v,
            self.circuits, self.height_m, self.is_flyable, self.tags,
        ]  # fmt: skip
        return hashlib.sha256(json.dumps(facts, sort_keys=True).encode()).hexdigest()


@dataclass
class Tally:
    """Counts the outcomes of rows."""

    left_out: Counter[str] = field(default_factory=Counter)  # rows, by reason
    unread: Counter[str] = field(default_factory=Counter)  # invalid values, by role
    unknown_kinds: Counter[str] = field(default_factory=Counter)


def checked_mapping(parameters: dict[str, Any], columns: Iterable[str]) -> Mapping:
    """Return the mapping of complete or partial parameters. Raises AssetFileError for invalid ones."""
    known = set(columns)
    kind = parameters.get("kind") or ""
    if isinstance(kind, dict):
        column, values = kind.get("column"), kind.get("values")
        _check_column("kind.column", column, known)
        values = values if isinstance(values, dict) else {}
        for value, meant in values.items():
            if meant not in (*KINDS, "", None):
                raise refused(f"kind.values.{str(value)[:40]}", f"{str(meant)[:40]!r} is none of {', '.join(KINDS)}")
        stated: dict[str, Any] = {"kind_column": str(column), "kinds": {_text(value): meant or "" for value, meant in values.items()}}
    elif kind in (*KINDS, BY_GEOMETRY, ""):
        stated = {"kind": kind}
    else:
        raise refused("kind", f"{str(kind)[:40]!r} is none of {', '.join((*KINDS, BY_GEOMETRY))}")
    chosen = {role: name for role, name in _object(parameters, "columns").items() if name}
    for role, name in chosen.items():
        if role not in ROLES:
            raise refused(f"columns.{str(role)[:40]}", f"there is no such meaning; known are {', '.join(ROLES)}")
        _check_column(f"columns.{role}", name, known)
    units = {role: unit for role, unit in _object(parameters, "units").items() if unit}
    for role, unit in units.items():
        if unit not in UNITS.get(role, ()):
            raise refused(
                f"units.{str(role)[:40]}", f"{str(unit)[:20]!r} is no unit that is known; height is in m or ft, voltage in V or kV"
            )
    return Mapping(columns=chosen, units=units, **stated)


def records_of(rows: Iterable[Row], mapping: Mapping, faults: RowFaults, tally: Tally) -> Iterator[AssetRecord]:
    """Yield the assets of the rows. Two rows with one key are a fault; without a key column the geometry is the key."""
    place_of_key: dict[tuple[str, str], str] = {}
    place_of_id: dict[str, str] = {}
    for row in rows:
        shape = row.geometry
        if shape is None:
            tally.left_out["no geometry"] += 1
            continue
        kind = mapping.kind_of(row, shape)
        if kind is None:
            tally.unknown_kinds[_text(row.properties.get(mapping.kind_column))] += 1
            continue
        if kind == "":
            tally.left_out["of a kind that is not wanted"] += 1
            continue
        try:
            _check_shape(kind, shape, row.place)
            key = _stated_key(row, mapping)
            external_id = _external_id(row, mapping, place_of_id)
            for number, part in enumerate(_parts(shape), start=1):
                own = f"{key}/{number}" if key and number > 1 else key or _key_of_shape(part)
                if not key:  # duplicates, such as two lines on the same towers
                    own = _free(place_of_key, kind, own)
                if earlier := place_of_key.get((kind, own)):
                    raise GeometryFault(row.place, f"the key {own[:60]!r} stands at {earlier} already")
                place_of_key[kind, own] = row.place
                yield _record(row, kind, own, part, mapping, tally, external_id if number == 1 else "")
        except GeometryFault as fault:
            faults.add(fault)


def _record(row: Row, kind: str, key: str, shape: BaseGeometry, mapping: Mapping, tally: Tally, external_id: str) -> AssetRecord:
    def stated(role: str) -> str:
        return _text(row.properties.get(mapping.columns.get(role, "")))

    subtype = stated("subtype").lower()[:40] or _SUBTYPES[kind]
    volts = _volts(stated("voltage"), mapping.units.get("voltage", "V"), tally)
    metres = _metres(stated("height"), mapping.units.get("height", "m"), tally)
    number = circuits(stated("circuits").removesuffix(".0"))
    tally.unread["circuits"] += bool(stated("circuits")) and number is None
    return AssetRecord(
        kind=kind, subtype=subtype, source_key=key, geometry=shape, name=stated("name")[:255], ref=stated("ref")[:255],
        operator=stated("operator")[:255], voltages_v=volts if kind in {"tower", "line"} else (),
        circuits=number, height_m=metres, length_m=path_length_m(np.asarray(shape.coords)) if shape.geom_type == "LineString" else None,
        is_flyable=not (kind == "line" and subtype in CABLE_KINDS) and not (kind == "railway" and subtype in RAILWAYS_OUT_OF_USE),
        tags={name: _text(value) for name, value in row.properties.items() if _text(value) and name != mapping.columns.get("external_id")},
        external_id=external_id,
    )  # fmt: skip


def _check_shape(kind: str, shape: Shape, place: str) -> None:
    if shape.geom_type not in _SHAPES[kind]:
        raise GeometryFault(place, f"a {kind} is drawn as {_DRAWN[kind]}, not as {_WORDS[shape.geom_type]}")


def _parts(shape: Shape) -> list[BaseGeometry]:
    """Return the assets of a shape: one per disjoint part of a line; an area is one, and stored as single if it has one part."""
    if shape.geom_type == "MultiLineString" or (shape.geom_type == "MultiPolygon" and len(shape.geoms) == 1):
        return list(shape.geoms)
    return [shape]


def _stated_key(row: Row, mapping: Mapping) -> str:
    if "key" not in mapping.columns:
        return ""
    key = _text(row.properties.get(mapping.columns["key"]))
    if not key:
        raise GeometryFault(row.place, f"the column {mapping.columns['key']!r}, which tells the assets apart, is empty")
    return key if len(key) <= MAX_KEY else "sha256:" + hashlib.sha256(key.encode()).hexdigest()


def _external_id(row: Row, mapping: Mapping, taken: dict[str, str]) -> str:
    """Return the external id; of a line split into several assets, the first one has it. Raises GeometryFault if invalid or duplicate."""
    found = _text(row.properties.get(mapping.columns.get("external_id", ""))).strip()
    if len(found) > MAX_EXTERNAL_ID or not found.isprintable():
        raise GeometryFault(row.place, f"an external id has at most {MAX_EXTERNAL_ID} characters, and no control characters")
    if found and found in taken:
        raise GeometryFault(row.place, f"the external id {found[:60]!r} stands at {taken[found]} already")
    if found:
        taken[found] = row.place
    return found


def _key_of_shape(shape: BaseGeometry) -> str:
    """Return a key of the shape to 1e-7 degrees (1 cm): programs differ in the last digits."""
    return "geometry:" + hashlib.sha256(shapely.to_wkb(shapely.transform(shape, lambda points: np.round(points, 7)))).hexdigest()[:32]


def _free(taken: dict[tuple[str, str], str], kind: str, key: str) -> str:
    number, found = 1, key
    while (kind, found) in taken:
        number += 1
        found = f"{key}/{number}"
    return found


def _volts(text: str, unit: str, tally: Tally) -> tuple[int, ...]:
    if not text:
        return ()
    in_unit = f"{text} kV" if unit == "kV" and not any(character.isalpha() for character in text) else text
    found = voltages_v(in_unit)
    tally.unread["voltage"] += not found
    return found


def _metres(text: str, unit: str, tally: Tally) -> float | None:
    if not text:
        return None
    number = number_of(text)
    found = length_m(text if number is None else f"{number:.6f} {unit}", maximum_m=MAX_HEIGHT_M)
    tally.unread["height"] += found is None
    return found


def _text(value: Cell) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return str(int(value))
    return str(value)


def _object(parameters: dict[str, Any], name: str) -> dict[str, Any]:
    value = parameters.get(name) or {}
    if not isinstance(value, dict):
        raise refused(name, "an object is expected")
    return value


def _check_column(place: str, name: Any, known: set[str]) -> None:
    if not isinstance(name, str) or name not in known:
        raise refused(place, f"the file has no column {str(name)[:60]!r}")
