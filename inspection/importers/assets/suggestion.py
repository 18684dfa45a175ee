"""Guesses what the columns of a file mean from their names and what is in them, in the words of several languages."""

import re
from typing import Any

from inspection.importers.assets.delimited import number_of
from inspection.importers.assets.mapping import BY_GEOMETRY
from inspection.importers.assets.survey import ColumnSurvey, Survey

# Names as they are found in the open data of grid operators, surveys and railways; compared without case, accents and signs.
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


def suggested_mapping(survey: Survey, *, file_name: str = "", geometry_columns: dict[str, str] | None = None) -> dict[str, Any]:
    """The same shape as the parameters of an import; what cannot be guessed is not in it."""
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


def _column_for(role: str, survey: Survey, taken: dict[str, str]) -> str | None:
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


def _can_be_key(column: ColumnSurvey, survey: Survey) -> bool:
    """Filled in every row, and no value twice as far as the values were counted."""
    repeated = column.values is not None and any(count > 1 for count in column.values.values())
    return column.filled == survey.rows and not repeated


def _kind(survey: Survey, file_name: str) -> Any:
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


def _units(survey: Survey, columns: dict[str, str]) -> dict[str, str]:
    units = {}
    if name := columns.get("voltage"):
        numbers = [number for sample in survey.columns[name].samples if (number := number_of(str(sample))) is not None]
        units["voltage"] = "kV" if "kv" in name.lower() or (numbers and max(numbers) < 2_000) else "V"
    if name := columns.get("height"):
        units["height"] = "ft" if re.search(r"(ft|feet|fuss)$", _folded(name)) else "m"
    return units


def _folded(text: str) -> str:
    return re.sub(r"[^a-z0-9]", "", text.lower().translate(_FOLDED))
