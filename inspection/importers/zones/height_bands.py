"""Height limits as ED-269 writes them: a unit, and two limits each with its reference."""

from typing import Any

from inspection.geodesy.geometry_validator import GeometryFault
from inspection.importers.zones.records import HEIGHT_REFERENCES, NO_CEILING, UNITS_M, HeightBand

BAND_KEYS = ("uomDimensions", "lowerLimit", "lowerVerticalReference", "upperLimit", "upperVerticalReference")
MAX_LIMIT_M = 100_000.0


def height_band(holder: dict[str, Any], place: str) -> HeightBand:
    """The band that an object states; a limit that is missing or null is not stated, which is not 0."""
    stated = {key: holder[key] for key in BAND_KEYS if holder.get(key) is not None}
    unit = stated.get("uomDimensions", "M")
    if not isinstance(unit, str) or unit not in UNITS_M:
        raise GeometryFault(f"{place}.uomDimensions", f"the unit is M or FT, not {str(unit)[:40]!r}")
    lower, upper = (_limit_m(stated, key, UNITS_M[unit], place) for key in ("lowerLimit", "upperLimit"))
    lower_reference, upper_reference = (_reference(stated, key, place) for key in ("lowerVerticalReference", "upperVerticalReference"))
    if lower is not None and upper is not None and lower_reference == upper_reference and upper < lower:
        raise GeometryFault(f"{place}.upperLimit", f"the upper limit {upper:g} m lies below the lower limit {lower:g} m")
    return HeightBand(lower, lower_reference if lower is not None else "", upper, upper_reference if upper is not None else "", stated)


def _limit_m(stated: dict[str, Any], key: str, unit_m: float, place: str) -> float | None:
    value = stated.get(key)
    if value is None or value == NO_CEILING:
        return None
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= MAX_LIMIT_M:
        raise GeometryFault(f"{place}.{key}", "a limit is a number of metres or feet")
    return float(value) * unit_m


def _reference(stated: dict[str, Any], key: str, place: str) -> str:
    reference = stated.get(key, "")
    if reference not in ("", *HEIGHT_REFERENCES):
        raise GeometryFault(f"{place}.{key}", f"the reference is AGL, AMSL or WGS84, not {str(reference)[:40]!r}")
    return str(reference)
