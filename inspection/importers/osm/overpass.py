"""Asking Overpass for an area's infrastructure: the question, and how large an area may be."""

import re
from math import isfinite, radians, sin

from inspection.importers.osm.records import Extent

EARTH_RADIUS_KM = 6_371.0088  # IUGG mean radius
QUERY_TIMEOUT_S = 180
# What reader.py makes assets of, with life-cycle states that it tells apart by itself.
_RAILWAYS = "rail|light_rail|narrow_gauge|tram|subway|monorail|funicular|preserved|miniature|disused|abandoned|construction"
_FILTERS = (
    'node["power"~"^(tower|pole|portal)$"]', 'way["power"~"^(line|minor_line|cable|minor_cable|portal|tower)$"]',
    f'way["railway"~"^({_RAILWAYS})$"]', 'way["bridge"]["bridge"!="no"]', 'way["man_made"="bridge"]',
    'relation["man_made"="bridge"]["type"="multipolygon"]',
)  # fmt: skip
_REMARK = re.compile(r'"remark"\s*:\s*"((?:[^"\\]|\\.){0,500})"')


class WrongArea(ValueError):
    """The box is none, or larger than what may be asked for at once."""


def checked_box(value: object, most_km2: float) -> Extent:
    """West, south, east, north [deg]. Raises WrongArea."""
    if not isinstance(value, list | tuple) or len(value) != 4 or not all(_is_finite_number(number) for number in value):
        raise WrongArea("The area is four numbers: west, south, east, north.")
    west, south, east, north = (float(number) for number in value)
    if not (-180 <= west < east <= 180 and -90 <= south < north <= 90):
        raise WrongArea("West lies before east and south before north, from -180 to 180 and from -90 to 90 degrees.")
    size_km2 = area_km2((west, south, east, north))
    if size_km2 > most_km2:
        raise WrongArea(f"The area has {size_km2:,.0f} km²; at most {most_km2:,.0f} km² are taken at once. Zoom in.")
    return west, south, east, north


def area_km2(box: Extent) -> float:
    """Of west, south, east, north [deg], on the sphere."""
    west, south, east, north = box
    return EARTH_RADIUS_KM**2 * radians(east - west) * (sin(radians(north)) - sin(radians(south)))


def question(box: Extent, *, most_bytes: int) -> str:
    """The text in Overpass QL: everything of the box with whole ways, as JSON; the server stops at the size that we would refuse."""
    west, south, east, north = box
    parts = "".join(f"{part};" for part in _FILTERS)
    area = f"{south:.7f},{west:.7f},{north:.7f},{east:.7f}"
    return f"[out:json][timeout:{QUERY_TIMEOUT_S}][maxsize:{most_bytes}][bbox:{area}];({parts});out meta;>;out meta qt;"


def complaint(tail: str) -> str:
    """What the answer itself says against being whole, from its last characters: a query that ran out of time or memory, or ""."""
    remark = _REMARK.search(tail)
    return remark[1] if remark and "error" in remark[1].lower() else ""


def _is_finite_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)
