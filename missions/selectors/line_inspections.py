"""Which parts of a line or railway were inspected, and when last; tiles of all inspections of an organisation."""

from collections import defaultdict
from collections.abc import Collection
from dataclasses import dataclass
from datetime import datetime
from typing import Any, NamedTuple
from uuid import UUID

from django.contrib.gis.db.models import GeometryField
from django.contrib.gis.geos import LineString
from django.db.models import Case, F, FloatField, Func, IntegerField, Q, QuerySet, TextField, When
from django.db.models.functions import Cast, Extract, Greatest, Least

from inspection.geodesy import LonLat
from inspection.geodesy.stretches import (
    FloatArray,
    LinePart,
    leads_back,
    nearest_on_line,
    newest_along,
    part_between,
    place_along,
    vertex_lengths_m,
)
from inspection.models import Asset, AssetKind
from inspection.selectors.picking import NotOneLine, course_of
from inspection.selectors.tiles import box_of_tile, tile_of_rows
from missions.selectors.missions import inspections_of_assets

POINTS_ZOOM = 10  # from where towers and bridges are in the tiles
OF_LENGTH = Q(position=None)  # whole lines and stretches; a place on a line has no length


class InspectedBy(NamedTuple):
    """The mission that inspected a part last."""

    inspected_at: datetime
    mission: UUID
    name: str


@dataclass(frozen=True)
class PartOfLine:
    """A part of a line that one mission inspected last; None: it was never inspected.

    `can_be_target`: whether its two ends mean this part, as those of a target do; not always where a line meets itself.
    """

    part: LinePart
    inspected: InspectedBy | None
    can_be_target: bool


def parts_inspected(organisation_id: int, line: Asset) -> list[PartOfLine]:
    """Return a line or railway from its first vertex to its last in parts. Raises NotOneLine where it is not drawn as one line."""
    course = course_of(line)
    vertex_m = vertex_lengths_m(course)
    targets: QuerySet[Any] = inspections_of_assets(organisation_id).filter(OF_LENGTH, asset=line).select_related("mission")
    rows = list(targets.order_by("inspected_at", "pk"))
    pieces = newest_along([_along_m(row.stretch, course, vertex_m) for row in rows], float(vertex_m[-1]))
    found = []
    for from_m, to_m, number in pieces:
        part = LinePart(place_along(course, vertex_m, from_m), place_along(course, vertex_m, to_m), from_m, to_m)
        row = None if number is None else rows[number]
        inspected = None if row is None else InspectedBy(row.inspected_at, row.mission_id, row.mission.name)
        found.append(PartOfLine(part, inspected, leads_back(course, vertex_m, part)))
    return found


def inspected_shares(organisation_id: int, lines: Collection[int]) -> dict[int, float]:
    """Return of lines and railways the share of their length, 0 to 1, that was ever inspected; without those not drawn as one line."""
    if not lines:
        return {}
    stretches: dict[int, list[LineString | None]] = defaultdict(list)
    inspected = inspections_of_assets(organisation_id).filter(OF_LENGTH, asset__in=lines)
    for asset, stretch in inspected.values_list("asset", "stretch").distinct().order_by():
        stretches[asset].append(stretch)
    shares = {}
    for line in Asset.objects.filter(pk__in=stretches).only("geometry"):
        try:
            course = course_of(line)
        except NotOneLine:
            continue
        vertex_m = vertex_lengths_m(course)
        length_m = float(vertex_m[-1])
        pieces = newest_along([_along_m(stretch, course, vertex_m) for stretch in stretches[line.pk]], length_m)
        inspected_m = sum(to_m - from_m for from_m, to_m, number in pieces if number is not None)
        shares[line.pk] = inspected_m / length_m if length_m else 1.0
    return shares


def _along_m(stretch: LineString | None, course: FloatArray, vertex_m: FloatArray) -> tuple[float, float]:
    """Return where along a line a target begins and ends, metres; None is the whole line."""
    if stretch is None:
        return 0.0, float(vertex_m[-1])
    first, second = (nearest_on_line(course, LonLat(*end[:2])) for end in stretch.coords)
    part = part_between(course, first, second, vertex_m)
    return part.from_m, part.to_m


def _place_on_line(point: str) -> Func:
    """Return how far along its asset a point of a target's stretch is, 0 to 1."""
    return Func(F("asset__geometry"), Func(F("stretch"), function=point), function="ST_LineLocatePoint", output_field=FloatField())


def inspections_tile(organisation_id: int, zoom: int, column: int, row: int) -> bytes:
    """Return the vector tile of the layer `inspections`: parts of lines, towers and bridges, each with `inspected_s` [Unix s].

    Parts of several missions may lie on each other. Empty where there is nothing. Raises NoSuchTile.
    """
    is_line = Q(asset__kind__in=[AssetKind.LINE, AssetKind.RAILWAY])
    rows: QuerySet[Any] = inspections_of_assets(organisation_id)
    seen = rows.filter(OF_LENGTH | ~is_line, asset__vanished_at=None, asset__geometry__bboverlaps=box_of_tile(zoom, column, row))
    if zoom < POINTS_ZOOM:
        seen = seen.filter(is_line)
    newest = seen.order_by("asset_id", "stretch", "-inspected_at", "-pk").distinct("asset_id", "stretch")
    rows = rows.filter(pk__in=newest.values("pk")).order_by("-inspected_at", "pk")
    first, second = _place_on_line("ST_StartPoint"), _place_on_line("ST_EndPoint")
    stretch = Func(
        F("asset__geometry"), Least(first, second), Greatest(first, second), function="ST_LineSubstring", output_field=GeometryField()
    )
    shown = rows.annotate(
        drawn_as=Func(F("asset__geometry"), function="GeometryType", output_field=TextField()),
        inspected_s=Cast(Extract("inspected_at", "epoch"), IntegerField()),
        shape=Case(
            When(is_line & Q(drawn_as="LINESTRING", stretch__isnull=False), then=stretch),
            When(is_line, then=F("asset__geometry")),
            default=F("asset__centre"),
            output_field=GeometryField(),
        ),
    )
    return tile_of_rows(shown, "inspections", ["asset", "inspected_s"], zoom, column, row)
