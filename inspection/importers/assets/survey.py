"""Survey of an asset file for the user who maps its columns: columns with samples, kinds of geometry, a preview."""

import json
import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import shapely

from inspection.importers.assets.asset_file import Row, Shape
from inspection.importers.assets.delimited import number_of
from inspection.importers.assets.mapping import BY_GEOMETRY
from inspection.importers.rows import Cell

MAX_SAMPLES = 5
MAX_VALUES = 50  # counted distinct values of a column; one with more is no kind column
PREVIEW_ROWS = 500
PREVIEW_VERTICES = 20_000
_DATE = re.compile(r"\d{4}-\d{2}-\d{2}([T ].*)?|\d{1,2}\.\d{1,2}\.\d{4}")
_FAMILIES = {"Point": "points", "LineString": "lines", "MultiLineString": "lines", "MultiPolygon": "areas"}


@dataclass
class ColumnSurvey:
    name: str
    samples: list[Cell] = field(default_factory=list)
    types: Counter[str] = field(default_factory=Counter)
    values: Counter[str] | None = field(default_factory=Counter)  # None once there are too many
    filled: int = 0

    def see(self, value: Cell) -> None:
        if value is None or value == "":
            return
        self.filled += 1
        self.types[_type_of(value)] += 1
        if len(self.samples) < MAX_SAMPLES and value not in self.samples:
            self.samples.append(value)
        if self.values is not None:
            self.values[str(value)] += 1
            if len(self.values) > MAX_VALUES:
                self.values = None

    @property
    def type(self) -> str:
        if not self.types:
            return "empty"
        if set(self.types) <= {"whole number", "number"}:
            return "number" if self.types["number"] else "whole number"
        return next(iter(self.types)) if len(self.types) == 1 else "text"


@dataclass
class AssetFileSurvey:
    columns: dict[str, ColumnSurvey]
    rows: int = 0
    without_geometry: int = 0
    geometries: Counter[str] = field(default_factory=Counter)  # points, lines, areas
    preview: list[dict[str, Any]] = field(default_factory=list)  # GeoJSON features
    extent: tuple[float, float, float, float] | None = None


def survey_of(rows: Iterable[Row], columns: Iterable[str] = ()) -> AssetFileSurvey:
    """Survey every row once, with little memory."""
    found = AssetFileSurvey({name: ColumnSurvey(name) for name in columns})
    vertices = 0
    for row in rows:
        found.rows += 1
        for name, value in row.properties.items():
            if name not in found.columns:
                found.columns[name] = ColumnSurvey(name)
            found.columns[name].see(value)
        if row.geometry is None:
            found.without_geometry += 1
            continue
        found.geometries[_FAMILIES[row.geometry.geom_type]] += 1
        found.extent = _grown(found.extent, row.geometry.bounds)
        if len(found.preview) < PREVIEW_ROWS and vertices < PREVIEW_VERTICES:
            vertices += int(shapely.get_num_coordinates(row.geometry))
            found.preview.append(_feature(row, row.geometry))
    return found


def _feature(row: Row, shape: Shape) -> dict[str, Any]:
    geometry = json.loads(shapely.to_geojson(shape))
    return {"type": "Feature", "properties": {"place": row.place, **row.properties}, "geometry": geometry}


def _grown(extent: tuple[float, float, float, float] | None, bounds: Any) -> tuple[float, float, float, float]:
    west, south, east, north = (float(bound) for bound in bounds)
    if extent is None:
        return west, south, east, north
    return min(extent[0], west), min(extent[1], south), max(extent[2], east), max(extent[3], north)


def _type_of(value: Cell) -> str:
    if isinstance(value, bool):
        return "yes or no"
    if isinstance(value, int):
        return "whole number"
    if isinstance(value, float):
        return "whole number" if value.is_integer() else "number"
    text = str(value)
    if _DATE.fullmatch(text):
        return "date"
    number = number_of(text)
    if number is None:
        return "text"
    return "whole number" if number.is_integer() else "number"


# Names found in open data of grid operators, surveys and railways; compared without case, accents and punctuation.
_NAMES = {
    "key": ("uuid", "globalid", "guid", "fid", "gid", "objectid", "objid", "osmid", "id", "key", "t_id", "xtf_id", "egid"),
    "external_id": ("externalid", "externeid", "assetid", "sapid", "sapnr", "equipmentnumber", "equipmentnr", "equnr"),
    "ref": (
        "ref", "nummer", "number", "nr", "no", "num", "mastnr", "mastnummer", "mast", "towerno", "towernumber", "structno", "bezeichnung",
        "designation", "code", "kennung", "linenr", "pylon", "numero", "id",
    ),
    "name": ("name", "title", "titel", "label", "nom", "nombre", "leitung", "linename", "trassenname", "trassename"),
    "operator": (
        "operator", "owner", "betreiber", "eigentuemer", "eigentumer", "netzbetreiber", "company", "exploitant", "proprietaire", "tso",
        "utility",
    ),
    "voltage": (
        "voltage", "volt", "volts", "kv", "voltagekv", "voltagev", "spannung", "spannungkv", "nennspannung", "unenn", "tension",
        "maxvoltage",
    ),
    "circuits": ("circuits", "circuit", "stromkreise", "systeme", "ncircuits", "circuitcount", "ternes"),
    "height": (
        "height", "heightm", "heightft", "hoehe", "hohe", "masthohe", "masthoehe", "hauteur", "altura", "towerheight", "structureheight",
    ),
    "subtype": ("subtype", "structure", "masttyp", "towertype", "bauart", "material"),
}  # fmt: skip
_KIND_COLUMNS = (
    "type",
    "kind",
    "typ",
    "art",
    "objektart",
    "objectclass",
    "class",
    "feature",
    "power",
    "category",
    "kategorie",
    "asset",
    "assettype",
)
_KINDS = {
    "tower": ("tower", "pylon", "mast", "pole", "portal", "stutze", "stuetze", "support", "structure", "pylone", "torre"),
    "line": (
        "line", "powerline", "leitung", "freileitung", "minorline", "transmissionline", "span", "conductor", "trasse", "overheadline",
        "ligne", "linea",
    ),
    "railway": ("railway", "rail", "track", "bahn", "gleis", "eisenbahn", "voie"),
    "bridge": ("bridge", "brucke", "bruecke", "pont", "puente", "viaduct", "viadukt"),
}  # fmt: skip
_RAILWAY_WORDS = ("rail", "bahn", "gleis", "track", "schiene")
_FOLDED = str.maketrans(
    {"ä": "a", "ö": "o", "ü": "u", "ß": "s", "é": "e", "è": "e", "ê": "e", "á": "a", "í": "i", "ó": "o", "ñ": "n", "ç": "c"}
)


def suggested_mapping(survey: AssetFileSurvey, *, file_name: str = "", geometry_columns: dict[str, str] | None = None) -> dict[str, Any]:
    """Return a mapping in the shape of an import's parameters, without what cannot be guessed."""
    columns: dict[str, str] = {}
    for role in ("key", "external_id", "ref", "name", "operator", "voltage", "circuits", "height", "subtype"):
        if (name := _column_for(role, survey, columns)) is not None:
            columns[role] = name
    found: dict[str, Any] = {"columns": columns}
    if (kind := _kind(survey, file_name)) is not None:
        found["kind"] = kind
    if units := _units(survey, columns):
        found["units"] = units
    if geometry_columns:
        found["geometry"] = geometry_columns
    return found


def _column_for(role: str, survey: AssetFileSurvey, taken: dict[str, str]) -> str | None:
    by_name = {_folded(name): name for name in reversed(survey.columns)}
    for word in _NAMES[role]:
        name = by_name.get(_folded(word))
        if name is None or (name in taken.values() and role != "ref"):
            continue
        column = survey.columns[name]
        if column.filled == 0 or (role in {"key", "external_id"} and not _can_be_key(column, survey)):
            continue
        if role in {"voltage", "circuits"} and not any(character.isdigit() for sample in column.samples for character in str(sample)):
            continue
        return name
    return None


def _can_be_key(column: ColumnSurvey, survey: AssetFileSurvey) -> bool:
    """Whether each row has a value, without duplicates as far as values were counted."""
    repeated = column.values is not None and any(count > 1 for count in column.values.values())
    return column.filled == survey.rows and not repeated


def _kind(survey: AssetFileSurvey, file_name: str) -> Any:
    by_name = {_folded(name): name for name in reversed(survey.columns)}
    for word in _KIND_COLUMNS:
        column = survey.columns.get(by_name.get(word, ""))
        if column is None or not column.values:
            continue
        meant = {value: _kind_of(value) for value in column.values}
        if any(meant.values()):
            return {"column": column.name, "values": {value: kind for value, kind in meant.items() if kind}}
    families = set(survey.geometries)
    if families == {"lines"}:
        words = _folded(file_name + " ".join(survey.columns))
        return "railway" if any(word in words for word in _RAILWAY_WORDS) else "line"
    if len(families) == 1:
        return {"points": "tower", "areas": "bridge"}[families.pop()]
    return BY_GEOMETRY if families else None


def _kind_of(value: str) -> str | None:
    word = _folded(value)
    return next((kind for kind, names in _KINDS.items() if any(word == name or word == f"{name}s" for name in names)), None)


def _units(survey: AssetFileSurvey, columns: dict[str, str]) -> dict[str, str]:
    units = {}
    if name := columns.get("voltage"):
        numbers = [number for sample in survey.columns[name].samples if (number := number_of(str(sample))) is not None]
        units["voltage"] = "kV" if "kv" in name.lower() or (numbers and max(numbers) < 2_000) else "V"
    if name := columns.get("height"):
        units["height"] = "ft" if re.search(r"(ft|feet|fuss)$", _folded(name)) else "m"
    return units


def _folded(text: str) -> str:
    return re.sub(r"[^a-z0-9]", "", text.lower().translate(_FOLDED))
