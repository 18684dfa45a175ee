"""Labels of assets on pages, in the API and in map tiles, and the parsing of generated names.

An asset without a ref and a name gets a name from its kind and its place: "Tower 18 of 41", "Bridge w42". Label and detail are in the
reader's language: made here for one row, and as SQL for tiles, which have thousands.
"""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import lru_cache

from django.conf import settings
from django.db.models import Q, QuerySet
from django.utils import translation
from django.utils.translation import gettext as _
from django.utils.translation import gettext_noop

from inspection.models import Asset, AssetKind

KIND_WORDS = {
    AssetKind.TOWER: gettext_noop("Tower"),
    AssetKind.LINE: gettext_noop("Line"),
    AssetKind.RAILWAY: gettext_noop("Railway"),
    AssetKind.BRIDGE: gettext_noop("Bridge"),
}
WORDS = {
    "line": gettext_noop("Line"),
    "minor_line": gettext_noop("Line"),
    "cable": gettext_noop("Cable"),
    "pole": gettext_noop("Pole"),
    "portal": gettext_noop("Portal"),
    "tram": gettext_noop("Tramway"),
    "subway": gettext_noop("Subway"),
}
PART = re.compile(r", km [0-9.]+–[0-9.]+$")
CARRIES = {
    "a road and a railway": gettext_noop("carries a road and a railway"),
    "a railway": gettext_noop("carries a railway"),
    "a road": gettext_noop("carries a road"),
    "a path": gettext_noop("carries a path"),
    "water": gettext_noop("carries water"),
    "a pipeline": gettext_noop("carries a pipeline"),
}
VOLTAGE_NOT_STATED = gettext_noop("voltage not stated")
PLACED = gettext_noop("%(kind)s %(place)s of %(places)s")
RAILWAY_OF = gettext_noop("%(operator)s railway")
NAMING = ("kind", "subtype", "place_on_line", "places_on_line", "osm_type", "osm_id")
NUMBERED = r" (?P<osm>[nwr])?(?P<number>\d{1,18})"


@dataclass(frozen=True)
class MadeName:
    """A parsed generated name: the kind's English word, and a place on a line, an OSM id ("w", 42), or the asset's own number."""

    noun: str
    place: tuple[int, int] | None = None
    osm: tuple[str, int] | None = None
    number: int | None = None

    def filter(self) -> Q:
        """Return a filter for the assets with this name."""
        subtypes = [subtype for subtype, noun in WORDS.items() if noun == self.noun]
        kinds = [kind for kind, noun in KIND_WORDS.items() if noun == self.noun]
        alike = Q(subtype__in=subtypes) | (Q(kind__in=kinds) & ~Q(subtype__in=list(WORDS)))
        if self.place is not None:
            return alike & Q(ref="", name="", line__isnull=False, place_on_line=self.place[0], places_on_line=self.place[1])
        if self.osm is not None:
            return alike & Q(osm_type=self.osm[0], osm_id=self.osm[1])
        return alike & Q(osm_id=None, pk=self.number)


def noun_of(kind: str, subtype: str) -> str:
    """Return one English word for such an asset; it is translated where it is shown."""
    return WORDS.get(subtype) or KIND_WORDS[AssetKind(kind)]


def assets_with_made_names(assets: QuerySet[Asset], names: Collection[MadeName]) -> dict[MadeName, list[int]]:
    """Return the primary keys of those of the assets that have these names."""
    places = [name.place for name in names if name.place is not None]
    placed = Q(
        ref="", name="", line__isnull=False, place_on_line__in={at for at, _of in places}, places_on_line__in={of for _at, of in places}
    )
    by_osm = Q(osm_id__in={name.osm[1] for name in names if name.osm is not None})
    by_number = Q(osm_id=None, pk__in={name.number for name in names if name.number is not None})
    found: dict[MadeName, list[int]] = {name: [] for name in names}
    for asset in assets.filter(placed | by_osm | by_number).only(*NAMING).order_by("pk"):
        noun = noun_of(asset.kind, asset.subtype)
        for name in (
            MadeName(noun, place=(asset.place_on_line or 0, asset.places_on_line or 0)),
            MadeName(noun, osm=(asset.osm_type, asset.osm_id or 0)),
            MadeName(noun, number=asset.pk),
        ):
            if name in found:
                found[name].append(asset.pk)
    return found


def made_name(text: str) -> MadeName | None:
    """Parse a generated name in any language of the pages; None for other texts. Case and double spaces do not matter."""
    plain = " ".join(text.split())
    for words, placed, numbered in _languages():
        if (match := placed.fullmatch(plain)) and (noun := words.get(match["word"].lower())):
            return MadeName(noun, place=(int(match["place"]), int(match["places"])))
        if (match := numbered.fullmatch(plain)) and (noun := words.get(match["word"].lower())):
            number = int(match["number"])
            return MadeName(noun, osm=(match["osm"].lower(), number)) if match["osm"] else MadeName(noun, number=number)
    return None


@lru_cache(maxsize=1)
def _languages() -> list[tuple[dict[str, str], re.Pattern[str], re.Pattern[str]]]:
    """Return for each language its lower-case words for kinds with their English, and the patterns of places on lines and of numbers."""
    languages = []
    for code, _name in settings.LANGUAGES:
        with translation.override(code):
            words = {_(noun).lower(): noun for noun in {*KIND_WORDS.values(), *WORDS.values()}}
            stated = _(PLACED) % {"kind": "{kind}", "place": "{place}", "places": "{places}"}
        word = rf"(?P<word>{'|'.join(map(re.escape, words))})"
        pattern = re.escape(stated).replace(r"\{kind\}", word)
        pattern = pattern.replace(r"\{place\}", r"(?P<place>\d{1,6})").replace(r"\{places\}", r"(?P<places>\d{1,6})")
        languages.append((words, re.compile(pattern, re.IGNORECASE), re.compile(word + NUMBERED, re.IGNORECASE)))
    return languages


def asset_label(asset: Asset) -> str:
    """Return an asset's label: ref, name, a support's place on its line ("Tower 18 of 41"), operator and voltage of a line, else its

    kind and OSM id ("Tower n42").

    The same as LABEL_SQL.
    """
    if given := asset.ref or asset.name:
        return given
    if asset.kind == AssetKind.LINE and (asset.operator or asset.max_voltage_v):
        return " ".join(part for part in (asset.operator, voltage_text(asset.max_voltage_v)) if part)
    if asset.kind == AssetKind.RAILWAY and asset.operator:
        return _(RAILWAY_OF) % {"operator": asset.operator}
    noun = _(noun_of(asset.kind, asset.subtype))
    if asset.line_id is not None:
        return _(PLACED) % {"kind": noun, "place": asset.place_on_line, "places": asset.places_on_line}
    return f"{noun} {asset.osm_type}{asset.osm_id}" if asset.osm_id is not None else f"{noun} {asset.pk}"


def part_label(asset: Asset, from_m: float, to_m: float) -> str:
    """Return the label of a part of a line or railway, along which it lies between these metres: "E402, km 9.8–10.8".

    Written alike in all languages: pages find the line's own label before the ", km".
    """
    return f"{asset_label(asset)}, km {from_m / 1_000.0:.1f}–{to_m / 1_000.0:.1f}"


def label_now(asset: Asset, stored: str) -> str:
    """Return the current label of an asset, or of its part that was stored under a label of `part_label`."""
    part = PART.search(stored)
    return asset_label(asset) + (part.group() if part else "")


def asset_detail(asset: Asset) -> str:
    """Return what the label omits: "138 kV AEP" of a support's line or of a line; what a bridge carries. It may be empty.

    Reads the line of a support: load it with select_related. The same as DETAIL_SQL.
    """
    given = asset.ref or asset.name
    operator = asset.operator if asset.operator != given else ""
    if asset.kind == AssetKind.TOWER and asset.line is not None:
        line = asset.line
        return _voltage_and_owner(voltage_text(line.max_voltage_v or asset.max_voltage_v), line.ref or line.name or line.operator)
    if asset.kind == AssetKind.TOWER:
        return f"{voltage_text(asset.max_voltage_v)} {operator}".strip()
    if asset.kind == AssetKind.LINE and (given or len(asset.voltages_v) != 1):
        return _voltage_and_owner(", ".join(map(voltage_text, asset.voltages_v)), operator if given else "")
    if asset.kind == AssetKind.RAILWAY and given:
        return ", ".join(fact for fact in (asset.name, operator) if fact and fact != given)
    return _(CARRIES[asset.carries]) if asset.carries else ""


def _voltage_and_owner(voltage: str, owner: str) -> str:
    if voltage:
        return f"{voltage} {owner}".strip()
    return f"{owner}, {_(VOLTAGE_NOT_STATED)}" if owner else _(VOLTAGE_NOT_STATED)


def voltage_text(voltage_v: int | None) -> str:
    return f"{voltage_v / 1000:g} kV" if voltage_v else ""


def _stated(values: Mapping[str, str], column: str, otherwise: str) -> str:
    """Return SQL for a column's value as a word in the reader's language, with parameters of `sql_words`."""
    cases = " ".join(f"WHEN '{value}' THEN %({noun})s" for value, noun in values.items())
    return f"CASE {column} {cases} ELSE {otherwise} END"


def _sql_voltage_and_owner(voltage: str, owner: str) -> str:
    not_stated = f"%({VOLTAGE_NOT_STATED})s"
    return f"COALESCE({voltage} || COALESCE(' ' || {owner}, ''), {owner} || ', ' || {not_stated}, {not_stated})"


def sql_words() -> dict[str, str]:
    """Return the parameters of LABEL_SQL and DETAIL_SQL in the reader's language, named by their English."""
    words = {noun: _(noun) for noun in {*KIND_WORDS.values(), *WORDS.values(), *CARRIES.values(), VOLTAGE_NOT_STATED}}
    placed = _(PLACED) % {"kind": "%1$s", "place": "%2$s", "places": "%3$s"}
    return words | {"placed": placed, "railway of": _(RAILWAY_OF) % {"operator": "%s"}}


# From the columns of an asset; of a support's line, if it is joined, line_voltage_v and line_owner.
LINE_VOLTAGE_V = "COALESCE(line_voltage_v, max_voltage_v)"
VOLTAGES_SQL = "(SELECT STRING_AGG(trim_scale(v / 1000.0) || ' kV', ', ') FROM UNNEST(voltages_v) v)"
_VOLTAGE = "trim_scale(max_voltage_v / 1000.0) || ' kV'"
_WORD = _stated(WORDS, "subtype", _stated({str(kind): noun for kind, noun in KIND_WORDS.items()}, "kind", "INITCAP(kind)"))
_GIVEN = "COALESCE(NULLIF(ref, ''), NULLIF(name, ''))"
_OPERATOR = f"NULLIF(NULLIF(operator, ''), {_GIVEN})"
LABEL_SQL = f"""COALESCE(
    {_GIVEN},
    CASE WHEN kind = 'line' THEN NULLIF(CONCAT_WS(' ', NULLIF(operator, ''), {_VOLTAGE}), '')
         WHEN kind = 'railway' AND operator <> '' THEN FORMAT(%(railway of)s, operator) END,
    CASE WHEN line_id IS NOT NULL THEN FORMAT(%(placed)s, {_WORD}, place_on_line, places_on_line)
         ELSE {_WORD} || ' ' || COALESCE(osm_type || osm_id, id::text) END
)"""
DETAIL_SQL = {  # null instead of an empty text
    AssetKind.LINE: f"""CASE WHEN {_GIVEN} IS NOT NULL THEN {_sql_voltage_and_owner(VOLTAGES_SQL, _OPERATOR)}
             WHEN CARDINALITY(voltages_v) <> 1 THEN {_sql_voltage_and_owner(VOLTAGES_SQL, "NULL")} END""",
    AssetKind.RAILWAY: f"""CASE WHEN {_GIVEN} IS NOT NULL
             THEN NULLIF(CONCAT_WS(', ', NULLIF(NULLIF(name, ''), {_GIVEN}), {_OPERATOR}), '') END""",
    AssetKind.BRIDGE: _stated(CARRIES, "carries", "NULL"),
    AssetKind.TOWER: f"""CASE WHEN line_id IS NOT NULL
             THEN {_sql_voltage_and_owner(f"trim_scale({LINE_VOLTAGE_V} / 1000.0) || ' kV'", "line_owner")}
             ELSE NULLIF(CONCAT_WS(' ', {_VOLTAGE}, {_OPERATOR}), '') END""",
}
