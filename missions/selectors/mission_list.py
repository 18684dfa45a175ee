"""Reads for the list of missions: filters, order, and the small drawing of each."""

import contextlib
import math
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import TYPE_CHECKING, Any, TypedDict
from uuid import UUID

from django.contrib.gis.db.models import GeometryField
from django.contrib.gis.geos import GEOSGeometry, LineString, Polygon
from django.core.cache import cache
from django.db.models import (
    BooleanField,
    CharField,
    Count,
    Exists,
    ExpressionWrapper,
    F,
    FloatField,
    Func,
    IntegerField,
    Max,
    OuterRef,
    Q,
    QuerySet,
    Subquery,
    Value,
)
from django.db.models.functions import Coalesce, Lower

from inspection.models import Asset, AssetKind
from inspection.selectors import ground_revision
from missions.models import InspectionTarget, Mission, MissionState, MissionUav, Route
from missions.selectors.stale_plans import landing_routes_without_base
from missions.selectors.uav_changes import missions_with_other_uavs
from workspace.cache_unavailable import CACHE_UNAVAILABLE
from workspace.models import Organisation

SKETCH_TOLERANCE_DEG = 0.0005  # about 50 m: less than a pixel of the list's drawing
SKETCH_STEPS = 400  # grid cells across the drawing; finer detail is invisible
SKETCH_SHAPE = 2.0  # width by height of the drawing, in metres on the ground
SKETCH_ROOM = 1.35  # the margins of the drawing show the surroundings
MIN_HALF_DEG = 0.004  # about 450 m: a single target has some surroundings too
MAX_LINES = 60
MAX_PLACES = 60
KEPT_S = 7 * 24 * 3600
NOT_PLANNED = -1.0  # sorts unplanned missions below planned ones

LAST_CHANGED_FIRST = "-changed"
# the list's columns by their names in the API → the annotations below
ORDERS = {
    "name": "sort_name",
    "author": "sort_author",
    "state": "sort_state",
    "targets": "target_count",
    "uavs": "uav_count",
    "distance": "sort_length_m",
    "time": "sort_duration_s",
    "changed": "updated_at",
}


@dataclass(frozen=True)
class MissionFilter:
    """Filter of the list; empty fields do not filter."""

    text: str = ""
    states: tuple[str, ...] = ()
    author: str = ""
    uav: int | None = None
    is_stale: bool | None = None
    changed_from: datetime | None = None
    changed_before: datetime | None = None
    external_id: str = ""
    target_external_id: str = ""
    is_deleted: bool | None = False  # None: either


def count_of(rows: QuerySet[Any]) -> Coalesce:
    """Return the number of these rows that belong to a mission, as an annotation of missions."""
    counted = rows.filter(mission=OuterRef("pk")).order_by().values("mission").annotate(number=Count("pk")).values("number")
    return Coalesce(Subquery(counted, output_field=IntegerField()), 0)


def with_simulated_uav(mission: str) -> Exists:
    """Return whether a simulated UAV flies the mission in this column of the outer query."""
    return Exists(MissionUav.objects.filter(mission=OuterRef(mission), uav__is_simulated=True))


def missions_found(organisation: Organisation, asked: MissionFilter) -> QuerySet[Mission]:
    """Return the missions that match a filter, without the columns of the list."""
    missions = Mission.objects.filter(organisation=organisation)
    if asked.is_deleted is not None:
        missions = missions.filter(deleted_at__isnull=not asked.is_deleted)
    if asked.text:
        of_targets = InspectionTarget.objects.filter(mission=OuterRef("pk"), label__icontains=asked.text)
        of_author = Q(author__username__icontains=asked.text)
        missions = missions.filter(Q(name__icontains=asked.text) | of_author | Exists(of_targets))
    if asked.states:
        missions = missions.filter(state__in=asked.states)
    if asked.author:
        missions = missions.filter(author__username=asked.author)
    if asked.uav is not None:
        missions = missions.filter(Exists(MissionUav.objects.filter(mission=OuterRef("pk"), uav=asked.uav)))
    if asked.is_stale is not None:
        others = missions_with_other_uavs(missions)
        stale = ~Q(state=MissionState.DRAFT) & (~Q(ground_revision=ground_revision()) | Q(landing_routes_without_base()) | Q(pk__in=others))
        missions = missions.filter(stale) if asked.is_stale else missions.exclude(stale)
    if asked.external_id:
        missions = missions.filter(external_id=asked.external_id)
    if asked.target_external_id:
        missions = missions.filter(Exists(InspectionTarget.objects.filter(mission=OuterRef("pk"), external_id=asked.target_external_id)))
    if asked.changed_from is not None:
        missions = missions.filter(updated_at__gte=asked.changed_from)
    if asked.changed_before is not None:
        missions = missions.filter(updated_at__lt=asked.changed_before)
    return missions


class MissionFigures(TypedDict):
    """Columns that the query for the list computes."""

    target_count: int
    unassigned_count: int
    uav_count: int
    is_simulated: bool
    duration_s: float | None


if TYPE_CHECKING:
    from django_stubs_ext import WithAnnotations

    ListedMission = WithAnnotations[Mission, MissionFigures]
else:
    ListedMission = Mission


def mission_rows(missions: QuerySet[Mission]) -> QuerySet[ListedMission]:
    """Return the missions with counts, times, routes and a sort key for each column."""
    ends_s = Max(F("departs_s") + F("duration_s"))
    last_end = Route.objects.filter(mission=OuterRef("pk")).order_by().values("mission").annotate(ends_s=ends_s).values("ends_s")
    return (
        missions.select_related("author")
        .annotate(
            target_count=count_of(InspectionTarget.objects.all()),
            unassigned_count=count_of(InspectionTarget.objects.exclude(unassigned_reason="")),
            uav_count=count_of(MissionUav.objects.all()),
            is_simulated=with_simulated_uav("pk"),
            duration_s=Subquery(last_end, output_field=FloatField()),
            # Aliases as real fields: a page's cursor reads these values, not those of the columns they are made from.
            sort_name=Lower("name", output_field=CharField()),
            sort_author=Lower(Coalesce(F("author__username"), Value("")), output_field=CharField()),
            sort_state=Lower("state", output_field=CharField()),
            sort_length_m=Coalesce(F("total_length_m"), Value(NOT_PLANNED), output_field=FloatField()),
            sort_duration_s=Coalesce(Subquery(last_end, output_field=FloatField()), Value(NOT_PLANNED), output_field=FloatField()),
        )
        .prefetch_related("routes")
    )


def order_of(name: str) -> tuple[str, str]:
    """Return the columns to sort by for a name such as "-changed", the last one unique. Raises KeyError for an unknown column."""
    sign = "-" if name.startswith("-") else ""
    return f"{sign}{ORDERS[name.removeprefix('-')]}", f"{sign}pk"


def counts_by_state(missions: QuerySet[Mission]) -> tuple[dict[str, int], dict[str, int]]:
    """Return the number of missions per state: first of existing ones, then of deleted ones."""
    there: dict[str, int] = {}
    deleted: dict[str, int] = {}
    is_gone = ExpressionWrapper(Q(deleted_at__isnull=False), output_field=BooleanField())
    rows = missions.order_by().annotate(is_gone=is_gone).values("state", "is_gone").annotate(count=Count("pk"))
    for state, is_deleted, count in rows.values_list("state", "is_gone", "count"):
        (deleted if is_deleted else there)[state] = count
    return there, deleted


def choices_of_filters(organisation: Organisation) -> dict[str, list[dict[str, Any]]]:
    """Return the authors and UAVs of existing missions, by name, each with its number of missions."""
    missions = Mission.objects.filter(organisation=organisation, deleted_at=None).order_by()
    authors = missions.exclude(author=None).values("author__username").annotate(missions=Count("pk")).order_by("author__username")
    uavs = (
        MissionUav.objects.filter(mission__organisation=organisation, mission__deleted_at=None)
        .exclude(uav=None)
        .order_by("uav__name")
        .values("uav", "uav__name")
        .annotate(missions=Count("mission", distinct=True))
    )
    return {
        "authors": [{"name": row["author__username"], "missions": row["missions"]} for row in authors],
        "uavs": [{"id": row["uav"], "name": row["uav__name"], "missions": row["missions"]} for row in uavs],
    }


# the drawing


def sketch(mission: Mission) -> list[list[list[float]]]:
    """Return the routes, simplified for a thumbnail; an empty one for a UAV that does not fly keeps its letter and colour."""
    return [_rounded(route.geometry) for route in mission.routes.all()]


def _rounded(line: GEOSGeometry | None) -> list[list[float]]:
    simple = None if line is None else line.simplify(SKETCH_TOLERANCE_DEG)
    coords = simple.coords if isinstance(simple, LineString) else ()
    return [[round(lon, 5), round(lat, 5)] for lon, lat, *_ in coords] if len(coords) > 1 else []


def surroundings(missions: Sequence[Mission]) -> dict[UUID, dict[str, Any]]:
    """Return for each mission its targets' places, and the lines and railways around them, drawn faintly under the routes.

    Cached until the mission or the map data change.
    """
    ground = ground_revision()
    keys = {mission.pk: f"mission-sketch:{mission.pk}:{mission.revision}:{ground}" for mission in missions}
    kept: dict[str, Any] = {}
    with contextlib.suppress(*CACHE_UNAVAILABLE):
        kept = cache.get_many(keys.values())
    found = {pk: kept[key] for pk, key in keys.items() if key in kept}
    missing = [mission for mission in missions if mission.pk not in found]
    places = _places_of([mission.pk for mission in missing])
    for mission in missing:
        at = places.get(mission.pk, [])
        routes = [place for line in sketch(mission) for place in line]
        found[mission.pk] = {"places": at[:MAX_PLACES], "lines": _lines_in(_box_of([*at, *routes]))}
    with contextlib.suppress(*CACHE_UNAVAILABLE):
        cache.set_many({keys[mission.pk]: found[mission.pk] for mission in missing}, KEPT_S)
    return found


def _places_of(missions: list[UUID]) -> dict[UUID, list[list[float]]]:
    rows = InspectionTarget.objects.filter(mission__in=missions).order_by("mission", "sequence")
    places: dict[UUID, list[list[float]]] = {}
    for mission, position, stretch, centre in rows.values_list("mission", "position", "stretch", "asset__centre"):
        at = position or centre or (stretch and stretch.centroid)
        if at:
            places.setdefault(mission, []).append([round(at.x, 5), round(at.y, 5)])
    return places


def _box_of(places: list[list[float]]) -> Polygon | None:
    """Return the area that the drawing shows: its shape and its margins; None without places."""
    if not places:
        return None
    west, east = min(lon for lon, _ in places), max(lon for lon, _ in places)
    south, north = min(lat for _, lat in places), max(lat for _, lat in places)
    lon, lat = (west + east) / 2, (south + north) / 2
    shrink = max(0.05, math.cos(math.radians(lat)))
    half_height = max((north - south) / 2, (east - west) / 2 * shrink / SKETCH_SHAPE, MIN_HALF_DEG) * SKETCH_ROOM
    half_width = half_height * SKETCH_SHAPE / shrink
    box = Polygon.from_bbox((lon - half_width, lat - half_height, lon + half_width, lat + half_height))
    box.srid = 4326
    return box


def _lines_in(box: Polygon | None) -> list[list[list[float]]]:
    if box is None:
        return []
    west, _, east, _ = box.extent
    tolerance_deg = max(SKETCH_TOLERANCE_DEG, (east - west) / SKETCH_STEPS)
    clipped = Func(
        Func(F("geometry"), Value(box.wkt), function="ST_ClipByBox2D", template="%(function)s(%(expressions)s::geometry)"),
        Value(tolerance_deg),
        function="ST_Simplify",
        output_field=GeometryField(srid=4326),
    )
    rows = (
        Asset.objects.filter(kind__in=(AssetKind.LINE, AssetKind.RAILWAY), vanished_at=None, geometry__bboverlaps=box)
        .order_by(F("length_m").desc(nulls_last=True))
        .annotate(clipped=clipped)
        .values_list("clipped", flat=True)[:MAX_LINES]
    )
    parts = [
        part for line in rows if line is not None and not line.empty for part in (line if line.geom_type == "MultiLineString" else [line])
    ]
    return [_rounded(part) for part in parts if part.geom_type == "LineString" and len(part.coords) > 1]
