"""Selecting many assets at once: by a list, in an area, the supports of a line, the bridges of a railway."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import shapely
from django.contrib.gis.geos import GEOSGeometry, LineString
from django.contrib.postgres.fields import ArrayField
from django.db import connection
from django.db.models import F, Func, Q, QuerySet, TextField, Value
from django.db.models.functions import Lower

from inspection.geodesy import LonLat, path_length_m
from inspection.geodesy.stretches import FloatArray, IntArray, LinePart, nearest_on_line, part_between, parts_of_line, vertex_lengths_m
from inspection.models import Asset, AssetKind
from inspection.network.stretch import Stretch, StretchPart, stretch_between, supports_in_order
from inspection.selectors.asset_names import asset_label, assets_with_made_names, made_name, part_label
from inspection.selectors.ground_data import supports_and_lines

Box = tuple[float, float, float, float]

MAX_IN_AN_AREA = 2_000
OSM_KEY = re.compile(r"(?:.*openstreetmap\.org/)?(N(?:ODE)?|W(?:AY)?|R(?:ELATION)?)[ /]?(\d{1,18})(?:[/?#].*)?", re.IGNORECASE)
LIST_OF_REFS = r"\s*;\s*"  # OpenStreetMap joins several references of an object as "12;13"
# Margin of the search for a path between two supports, in degrees: first narrow, then wide.
REACHES_DEG = (0.05, 0.5)
SECTION_GAP_DEG = 0.002  # some 200 m: a bridge or a switch with another name may separate sections of one railway
MAX_CROSSINGS = 500  # of a drawn line with itself: computing its area takes time quadratic in them
SIDES_AT_ONCE = 256
BESIDE_DEG = 1e-5  # about a metre: a bridge's outline may end where the section begins
DEFAULT_PART_M = 1_000.0  # of a line that UAVs share
LONGER = 1.1
PER_CENTIMETRE = 1e7  # of a degree
CARRIES_TRACK = ("", "a railway", "a road and a railway")  # "": its ways do not state what it carries


class NotOnTheLine(Exception):
    """Raised for a support that is not on the line."""


class TooTangled(Exception):
    """Raised for a drawn line that crosses itself too often to enclose an area."""


class NoWayAlongLines(Exception):
    """Raised when no line leads from one support to the other."""


class NoStretch(Exception):
    """Raised where both ends of a stretch are one place."""


class NotOneLine(Exception):
    """Raised for a line or railway that is not drawn as one line, so that it cannot be flown along."""


def plain_ref(text: str) -> str:
    """Return the reference in a form that ignores case and spaces."""
    return "".join(character.lower() for character in " ".join(text.split()))  # character by character, as PostgreSQL does


def assets_called(refs: Iterable[str], *, kinds: Sequence[AssetKind] = ()) -> dict[str, list[int]]:
    """Return for each reference, as plain_ref writes it, the primary keys of the assets that it may mean.

    An asset's own reference, key or OSM id takes precedence over one of several references, and that over a given or generated name.
    """
    wanted = {plain_ref(ref) for ref in refs}
    osm = {ref: (match[1][0].lower(), int(match[2])) for ref in wanted if (match := OSM_KEY.fullmatch(ref))}
    parts = Func(Lower("ref"), Value(LIST_OF_REFS), function="regexp_split_to_array", output_field=ArrayField(TextField()))
    assets = Asset.objects.filter(vanished_at=None, is_flyable=True)
    if kinds:
        assets = assets.filter(kind__in=kinds)
    listed = sorted(wanted)
    called = assets.annotate(own=_plain("ref"), called=_plain("name"), keyed=_plain("source_key"), ref_parts=parts).filter(
        Q(own__in=listed) | Q(called__in=listed) | Q(keyed__in=listed) | Q(ref__contains=";", ref_parts__overlap=listed)
    )
    ranked: dict[str, dict[int, int]] = {ref: {} for ref in wanted}

    def note(ref: str, pk: int, rank: int) -> None:
        if ref in ranked:
            ranked[ref][pk] = min(rank, ranked[ref].get(pk, rank))

    for pk, own, name, key, several in called.order_by("pk").values_list("pk", "own", "called", "keyed", "ref_parts"):
        note(own, pk, 0)
        note(key, pk, 0)
        for part in several:
            note(plain_ref(part), pk, 1)
        note(name, pk, 2)
    if osm:
        by_key: dict[tuple[str, int | None], list[int]] = {}
        for pk, kind, osm_id in assets.filter(osm_id__in=[osm_id for _, osm_id in osm.values()]).values_list("pk", "osm_type", "osm_id"):
            by_key.setdefault((kind, osm_id), []).append(pk)
        for ref, key in osm.items():
            for pk in by_key.get(key, []):
                note(ref, pk, 0)
    made = {ref: name for ref in wanted if (name := made_name(ref)) is not None}
    if made:
        keys = assets_with_made_names(assets, set(made.values()))
        for ref, name_made in made.items():
            for pk in keys[name_made]:
                note(ref, pk, 2)
    return {ref: [pk for pk, rank in found.items() if rank == min(found.values())] for ref, found in ranked.items()}


def _plain(column: str) -> Lower:
    squeezed = Func(F(column), Value(r"\s+"), Value(" "), Value("g"), function="regexp_replace", output_field=TextField())
    return Lower(Func(squeezed, function="btrim", output_field=TextField()))


def assets_in_area(area: GEOSGeometry, kinds: Sequence[AssetKind]) -> QuerySet[Asset]:
    """Return the flyable assets that meet the area."""
    return Asset.objects.filter(vanished_at=None, is_flyable=True, kind__in=kinds, geometry__intersects=area).order_by("pk")


def area_drawn(ring: Sequence[Sequence[float]]) -> GEOSGeometry | None:
    """Return the area of a drawn outline, which may cross itself; None where it encloses nothing.

    Longitudes may exceed 180 degrees on a panned map. Raises TooTangled.
    """
    _refuse_a_tangle(ring)
    drawn = shapely.make_valid(shapely.Polygon(ring))
    world = shapely.box(-180.0, -90.0, 180.0, 90.0)
    turns = [shapely.transform(drawn, partial(np.add, (turn, 0.0))) for turn in (-360.0, 0.0, 360.0)]
    area = shapely.union_all([shapely.intersection(turn, world) for turn in turns])
    parts = [part for part in shapely.get_parts(area) if part.geom_type == "Polygon"]
    parts += [inner for part in shapely.get_parts(area) if part.geom_type == "MultiPolygon" for inner in part.geoms]
    return GEOSGeometry(memoryview(shapely.to_wkb(shapely.MultiPolygon(parts))), srid=4326) if parts else None


def _refuse_a_tangle(ring: Sequence[Sequence[float]]) -> None:
    corners = np.array(ring, dtype=float)
    corners = corners[(corners != np.roll(corners, 1, axis=0)).any(axis=1)]  # without repeated corners
    sides = np.asarray(shapely.linestrings(np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)), dtype=object)
    tree, crossings = shapely.STRtree(sides), 0
    for first in range(0, len(sides), SIDES_AT_ONCE):
        side, other = tree.query(sides[first : first + SIDES_AT_ONCE], predicate="intersects")
        apart = other - side - first
        crossings += int(((apart > 1) & (apart < len(sides) - 1)).sum())  # neighbours share a corner
        if crossings > MAX_CROSSINGS:
            raise TooTangled


@dataclass(frozen=True)
class RailwayBridges:
    sections: list[int]
    bridges: list[int]


def supports_of_line(line: Asset) -> tuple[int, ...]:
    """Return the primary keys of the line's supports in its direction."""
    supports, ways = supports_and_lines(_around([line]), line=line.pk)
    return supports_in_order(supports, ways)


def _around(lines: Sequence[Asset]) -> Box:
    extents = np.array([line.geometry.extent for line in lines])
    (west, south), (east, north) = extents[:, :2].min(axis=0).tolist(), extents[:, 2:].max(axis=0).tolist()
    return west - BESIDE_DEG, south - BESIDE_DEG, east + BESIDE_DEG, north + BESIDE_DEG


def parts_of_asset(asset: Asset, part_m: float, ends: Sequence[LonLat] | None = None) -> list[LinePart]:
    """Return the parts of a line or railway, or of its stretch between the places nearest to `ends`; a line is cut at its supports.

    Raises NotOneLine, and NoStretch where both ends are one place.
    """
    course = course_of(asset)
    stretch = None if ends is None else (nearest_on_line(course, ends[0]), nearest_on_line(course, ends[1]))
    parts = parts_of_line(course, part_m, ends=stretch, at=_vertices_at(_support_keys([asset]), course))
    if parts[0].start == parts[-1].end and len(parts) == 1 and ends is not None:
        raise NoStretch
    return parts


def _support_keys(assets: Sequence[Asset]) -> IntArray:
    """Return the places of supports around the lines among the assets, as _keys."""
    lines = [asset for asset in assets if asset.kind == AssetKind.LINE]
    if not lines:
        return np.zeros(0, dtype=np.int64)
    supports, _ways = supports_and_lines(_around(lines), line=0)
    return _keys(supports.position)


def _keys(position: FloatArray) -> IntArray:
    """Return a number for each position (n, 2), alike for those that are alike within a centimetre."""
    lon, lat = np.round(position * PER_CENTIMETRE).astype(np.int64).T
    keys: IntArray = lon * (1 << 32) + lat
    return keys


def _vertices_at(support_keys: IntArray, course: FloatArray) -> IntArray:
    return np.flatnonzero(np.isin(_keys(course), support_keys))


def parts_of_assets(lines: Sequence[Asset], most: int, area: GEOSGeometry | None = None) -> list[tuple[Asset, LinePart]]:
    """Return the parts of several lines and railways, each with its line, at most so many unless there are more lines.

    area: only parts that come into it count. What is not one line is left out, as it cannot be flown along.
    """
    keys = _support_keys(lines)
    flown = [(line, course_of(line)) for line in lines if isinstance(line.geometry, LineString)]
    cuts = [_vertices_at(keys, course) for _line, course in flown]
    longest_m, part_m = max((path_length_m(course) for _line, course in flown), default=0.0), DEFAULT_PART_M
    within = None if area is None else shapely.from_wkb(bytes(area.wkb))
    shapely.prepare(within)
    while True:
        found = [
            (line, part)
            for (line, course), at in zip(flown, cuts, strict=True)
            for part in parts_of_line(course, part_m, at=at)
            if within is None or shapely.intersects(within, shapely.linestrings(_course_of(part, course)))
        ]
        if len(found) <= most or part_m > longest_m:
            return found
        part_m *= max(LONGER, len(found) / most)


def _course_of(part: LinePart, line: FloatArray) -> FloatArray:
    vertex_m = vertex_lengths_m(line)
    return np.array([part.start, *line[(vertex_m > part.from_m) & (vertex_m < part.to_m)], part.end])


def label_between(line: Asset, start: LonLat, end: LonLat) -> str:
    """Return the label of a line's stretch between two places, or the line's own where it is not one line."""
    try:
        course = course_of(line)
    except NotOneLine:
        return asset_label(line)
    part = part_between(course, nearest_on_line(course, start), nearest_on_line(course, end))
    return part_label(line, part.from_m, part.to_m)


def course_of(line: Asset) -> FloatArray:
    """Return the vertices of a line or railway, (n, 2), lon lat [deg]. Raises NotOneLine where it is not drawn as one line."""
    if not isinstance(line.geometry, LineString):
        raise NotOneLine
    return np.array(line.geometry.coords, dtype=np.float64)[:, :2]


def supports_between(line: Asset, start: int, end: int) -> tuple[int, ...]:
    """Return the line's supports from one to the other, in this direction. Raises NotOnTheLine."""
    supports = supports_of_line(line)
    for support in (start, end):
        if support not in supports:
            raise NotOnTheLine(support)
    first, last = supports.index(start), supports.index(end)
    return supports[first : last + 1] if first <= last else supports[last : first + 1][::-1]


def stretch_along_lines(start: Asset, end: Asset) -> Stretch:
    """Return the path from one support to another along lines, on their common circuit if possible. Raises NoWayAlongLines."""
    (a, b), (c, d) = start.centre.coords, end.centre.coords
    west, south, east, north = min(a, c), min(b, d), max(a, c), max(b, d)
    circuit = _circuit_of(start, end)
    least = 0.25 * max(east - west, north - south)
    for reach in dict.fromkeys(max(reach, least) for reach in REACHES_DEG):  # for distant supports both are the same
        box = (max(west - reach, -180.0), max(south - reach, -90.0), min(east + reach, 180.0), min(north + reach, 90.0))
        supports, lines = supports_and_lines(box)
        stretch = stretch_between(supports, lines, start.pk, end.pk, circuit)
        if stretch is not None:
            return stretch
    raise NoWayAlongLines


def _circuit_of(start: Asset, end: Asset) -> set[int]:
    """Return the lines of a voltage that both supports carry; all lines where they have none in common."""
    of_start, of_end = _voltages_at(start), _voltages_at(end)
    common = of_start & of_end
    lines = Asset.objects.filter(kind=AssetKind.LINE, vanished_at=None, is_flyable=True)
    return set(lines.filter(max_voltage_v__in=common).values_list("pk", flat=True)) if common else set()


def _voltages_at(support: Asset) -> set[int]:
    lines = Asset.objects.filter(kind=AssetKind.LINE, vanished_at=None, is_flyable=True, geometry__dwithin=(support.centre, BESIDE_DEG))
    return {voltage for voltage in lines.values_list("max_voltage_v", flat=True) if voltage}


def sections_of_railway(railway: Asset) -> list[int]:
    """Return the railway, and sections connected to it with the same reference or, without one, the same name."""
    same = {"ref": railway.ref} if railway.ref else {"name": railway.name} if railway.name else {"pk": railway.pk}
    sections = Asset.objects.filter(kind=AssetKind.RAILWAY, vanished_at=None, **same).values_list("pk", flat=True)
    if len(sections) < 2:
        return [railway.pk]
    rows = _rows(
        """
        WITH clustered AS (
            SELECT id, ST_ClusterDBSCAN(geometry, %s, 1) OVER () AS cluster FROM inspection_asset WHERE id = ANY(%s)
        )
        SELECT id FROM clustered WHERE cluster = (SELECT cluster FROM clustered WHERE id = %s) ORDER BY id
        """,
        [SECTION_GAP_DEG, list(sections), railway.pk],
    )
    return [pk for (pk,) in rows]


def bridges_of_railway(railway: Asset, *, all_sections: bool, also_over: bool) -> RailwayBridges:
    """Return the bridges that carry the section, or all sections of its railway; with `also_over` those that cross it as well."""
    sections = sections_of_railway(railway) if all_sections else [railway.pk]
    rows = _rows(
        """
        SELECT DISTINCT b.id FROM inspection_asset r
        JOIN inspection_asset b ON b.kind = 'bridge' AND b.vanished_at IS NULL AND b.is_flyable
          AND ST_DWithin(b.geometry, r.geometry, %s)
        WHERE r.id = ANY(%s) AND (%s OR b.carries = ANY(%s))
        ORDER BY b.id
        """,
        [BESIDE_DEG, sections, also_over, list(CARRIES_TRACK)],
    )
    return RailwayBridges(sections, [pk for (pk,) in rows])


def _rows(statement: str, parameters: Sequence[Any]) -> list[tuple[Any, ...]]:
    with connection.cursor() as cursor:
        cursor.execute(statement, parameters)
        return cursor.fetchall()


__all__ = [
    "DEFAULT_PART_M",
    "MAX_IN_AN_AREA",
    "NoStretch",
    "NoWayAlongLines",
    "NotOnTheLine",
    "NotOneLine",
    "RailwayBridges",
    "StretchPart",
    "TooTangled",
    "area_drawn",
    "assets_called",
    "assets_in_area",
    "bridges_of_railway",
    "label_between",
    "parts_of_asset",
    "parts_of_assets",
    "plain_ref",
    "stretch_along_lines",
    "supports_between",
    "supports_of_line",
]
