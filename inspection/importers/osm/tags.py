"""OSM tags as typed values; invalid text becomes "not stated"."""

import re
from collections.abc import Mapping

Tags = Mapping[str, str]

MAX_VOLTAGE_V = 2_000_000  # the highest in service is 1,150,000 V
MAX_CIRCUITS = 100
MAX_HEIGHT_M = 1_000.0  # the tallest supports are 385 m high
MAX_WIDTH_M = 200.0

FOOT_M = 0.3048
INCH_M = 0.0254
_LENGTH_UNITS_M = {
    "": 1.0, "m": 1.0, "metre": 1.0, "metres": 1.0, "meter": 1.0, "meters": 1.0, "cm": 0.01,
    "ft": FOOT_M, "feet": FOOT_M, "foot": FOOT_M, "'": FOOT_M, "in": INCH_M, '"': INCH_M,
}  # fmt: skip
_VOLT_UNITS_V = {"": 1.0, "v": 1.0, "volt": 1.0, "volts": 1.0, "kv": 1_000.0, "mv": 1_000_000.0}

SUPPORT_KINDS = frozenset({"tower", "pole", "portal"})
OVERHEAD_KINDS = frozenset({"line", "minor_line"})
CABLE_KINDS = frozenset({"cable", "minor_cable"})
RAILWAYS_IN_USE = frozenset({"rail", "light_rail", "narrow_gauge", "tram", "subway", "monorail", "funicular", "preserved", "miniature"})
RAILWAYS_OUT_OF_USE = frozenset({"disused", "abandoned", "construction"})

_DENIALS = frozenset({"", "no", "false", "0", "none"})
_OUT_OF_SIGHT = frozenset({"underground", "underwater", "indoor"})
_NUMBER = r"\d{1,12}(?:[.,]\d{1,12})?"
_VOLTAGE = re.compile(rf"\s*({_NUMBER})\s*([a-z]*)\s*", re.IGNORECASE | re.ASCII)
_THOUSANDS = re.compile(r"(?<![\d.,])(\d{1,3})((?:,\d{3})+)(?![\d.,])", re.ASCII)
_LENGTH = re.compile(rf"[~<>≈]?\s*({_NUMBER})\s*([a-z'\"]*)\s*", re.IGNORECASE | re.ASCII)
_FEET_AND_INCHES = re.compile(r"\s*(\d{1,4})\s*(?:'|ft)\s*(\d{1,2}(?:\.\d{1,3})?)\s*(?:\"|in)?\s*", re.IGNORECASE | re.ASCII)


def affirms(value: str | None) -> bool:
    """Whether a yes-or-no tag such as bridge, tunnel or disused has yes, or a kind, which means yes."""
    return value is not None and value.strip().lower() not in _DENIALS


def voltages_v(value: str | None) -> tuple[int, ...]:
    """Return each voltage of a list such as "138000;69000", "110 kV" or "220000-400000" in volts, highest first, without duplicates.

    A comma separates values, unless digits are grouped by thousands as in "138,000". Unreadable values are omitted. A single unit at the
    end applies to the whole list ("110/20 kV"), but only to values too small to be volts.
    """
    if not value:
        return ()
    parts = re.split(r"[;/|,+&–]|(?<=[\dvV ])-(?=[\d ])", _THOUSANDS.sub(lambda match: match[0].replace(",", ""), value[:500]))
    found = [(float(match[1].replace(",", ".")), match[2].lower()) for part in parts if (match := _VOLTAGE.fullmatch(part))]
    last_unit = found[-1][1] if found else ""
    volts = set()
    for number, unit in found:
        meant = last_unit if unit == "" and number < 1_000 else unit
        if meant in _VOLT_UNITS_V:
            volts.add(round(number * _VOLT_UNITS_V[meant]))
    return tuple(sorted((v for v in volts if 0 < v <= MAX_VOLTAGE_V), reverse=True))


def circuits(value: str | None) -> int | None:
    """Return the number of circuits, if the tag is a plain number."""
    if value is None or not re.fullmatch(r"\s*\d{1,4}\s*", value, re.ASCII):
        return None
    number = int(value)
    return number if 0 < number <= MAX_CIRCUITS else None


def length_m(value: str | None, *, maximum_m: float) -> float | None:
    """Return a height or width such as "45", "45.5 m", "148 ft" or 12'6" in metres; None if invalid or beyond the maximum."""
    if not value:
        return None
    if match := _FEET_AND_INCHES.fullmatch(value[:50]):
        metres = int(match[1]) * FOOT_M + float(match[2]) * INCH_M
    elif (match := _LENGTH.fullmatch(value[:50])) and match[2].lower() in _LENGTH_UNITS_M:
        metres = float(match[1].replace(",", ".")) * _LENGTH_UNITS_M[match[2].lower()]
    else:
        return None
    return metres if 0.0 < metres <= maximum_m else None


def height_m(tags: Tags) -> float | None:
    return length_m(tags.get("height"), maximum_m=MAX_HEIGHT_M)


def width_m(tags: Tags) -> float | None:
    return length_m(tags.get("width"), maximum_m=MAX_WIDTH_M)


def is_bridge(tags: Tags) -> bool:
    return affirms(tags.get("bridge"))


def railway_kind(tags: Tags) -> str | None:
    """Return the kind of a railway track, in use or not; None for platforms, stations, proposals and other values."""
    kind = tags.get("railway")
    return kind if kind in RAILWAYS_IN_USE or kind in RAILWAYS_OUT_OF_USE else None


def power_way_kind(tags: Tags) -> str | None:
    kind = tags.get("power")
    return kind if kind in OVERHEAD_KINDS or kind in CABLE_KINDS else None


def is_out_of_sight(tags: Tags) -> bool:
    """Whether it is below ground or water, or under a roof, where no UAV can follow it."""
    return tags.get("location", "").lower() in _OUT_OF_SIGHT or affirms(tags.get("tunnel")) or tags.get("covered") == "yes"


def is_out_of_use(tags: Tags) -> bool:
    return any(affirms(tags.get(key)) for key in ("disused", "abandoned", "razed", "demolished"))


def is_flyable_line(tags: Tags) -> bool:
    """Whether it is an overhead line in use, outside a substation's own busbars and bays."""
    return (
        tags.get("power") in OVERHEAD_KINDS
        and tags.get("line") not in {"busbar", "bay"}
        and not is_out_of_sight(tags)
        and not is_out_of_use(tags)
    )


def is_flyable_railway(tags: Tags) -> bool:
    return tags.get("railway") in RAILWAYS_IN_USE and not is_out_of_sight(tags) and not is_out_of_use(tags)


# Carriageway widths [m] where neither width nor lanes are tagged: usual cross-sections, verges and kerbs included.
_HIGHWAY_WIDTH_M = {
    "motorway": 12.0, "trunk": 11.0, "primary": 10.0, "secondary": 9.0, "tertiary": 8.0, "motorway_link": 7.0, "trunk_link": 7.0,
    "primary_link": 7.0, "secondary_link": 7.0, "tertiary_link": 7.0, "unclassified": 6.0, "residential": 7.0, "living_street": 6.0,
    "service": 4.5, "track": 4.0, "pedestrian": 5.0, "cycleway": 3.0, "footway": 2.5, "path": 2.0, "steps": 2.0, "bridleway": 2.5,
}  # fmt: skip
_TRACK_WIDTH_M = {"rail": 6.0, "narrow_gauge": 4.5}  # a single track with its walkways
_LANE_WIDTH_M = 3.5
_SHOULDERS_M = 2.0
OTHER_BRIDGE_WIDTH_M = 5.0


def bridge_width_m(tags: Tags) -> float:
    """Return the width of the bridge under a way: as tagged, else by lanes or tracks, else usual for its kind."""
    stated = width_m(tags)
    if stated is not None:
        return stated
    if tags.get("railway") in RAILWAYS_IN_USE:
        return _TRACK_WIDTH_M.get(tags["railway"], 5.0) * (circuits(tags.get("tracks")) or 1)
    lanes = circuits(tags.get("lanes"))
    if lanes is not None and "highway" in tags:
        return min(lanes * _LANE_WIDTH_M + _SHOULDERS_M, MAX_WIDTH_M)
    return _HIGHWAY_WIDTH_M.get(tags.get("highway", ""), OTHER_BRIDGE_WIDTH_M)
