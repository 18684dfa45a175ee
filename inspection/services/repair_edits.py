"""The assets as each repair would leave them; nothing here is saved."""

from dataclasses import dataclass
from functools import partial
from math import isfinite
from typing import Any

import numpy as np
from django.contrib.gis.geos import LineString, MultiPoint, Point, Polygon
from django.db.models import QuerySet
from django.utils.translation import gettext as _

from inspection.geodesy.wgs84 import FloatArray
from inspection.models import Asset, AssetKind, DataIssue, OsmType
from inspection.network.infrastructure import NO_OSM_NODE
from inspection.quality.lines import MAX_V, MAX_VALUES
from inspection.quality.repair import (
    NoSuchVertex,
    end_moved_to,
    evenly_between,
    in_order,
    leg_between,
    nearest_leg,
    through,
    vertex_at,
    with_vertices,
)
from inspection.quality.supports import course_of_row
from inspection.services.curation import PLACED

MAX_TOWERS = 500  # along one span
REACH_M = 200.0  # largest distance of clicked places from the straight span
ATTACH_M = 500.0  # a tower farther from a line does not belong to it

# Tags from which the bridge's `carries` follows; highway=road is OSM's "a road of whatever kind".
_CARRIED = {
    "road": {"highway": "road"}, "railway": {"railway": "rail"}, "path": {"highway": "path"}, "water": {"waterway": "canal"},
    "pipeline": {"man_made": "pipeline"},
}  # fmt: skip


class CannotRepair(ValueError):
    """Raised when a repair is not possible, with the reason and the remedy."""


@dataclass(frozen=True)
class RepairEdit:
    asset: Asset
    is_new: bool = False


def towers_along_span(issue: DataIssue, parameters: dict[str, Any]) -> list[RepairEdit]:
    """Return new vertices in the span with a tower each: at the given places, else evenly, as many as are presumed missing."""
    line = _line(issue.asset_id)
    course, details = list(line.geometry.coords), issue.details
    start, end = details["start"], details["end"]
    leg = _found(lambda: leg_between(course, start, end))
    if "positions" in parameters:
        given = _positions(parameters["positions"])
        if any(nearest_leg([tuple(start), tuple(end)], place)[2] > REACH_M for place in given):
            raise CannotRepair(_("A tower along the span stands within %(reach_m)s m of it.") % {"reach_m": f"{REACH_M:.0f}"})
        places = in_order(start, end, given)
    else:
        places = evenly_between(start, end, min(details["missing_towers"], MAX_TOWERS))
    line.geometry = LineString(with_vertices(course, leg, places), srid=4326)
    return [RepairEdit(line), *(_new_tower(line, place, NO_OSM_NODE) for place in places)]


def towers_at_vertices(issue: DataIssue, parameters: dict[str, Any]) -> list[RepairEdit]:
    """Return a tower at each vertex of the line that has none; an OSM node there identifies the tower."""
    line = _line(issue.asset_id)
    course = line.geometry.coords
    nodes = line.node_osm_ids if len(line.node_osm_ids) == len(course) else [NO_OSM_NODE] * len(course)
    drawn = issue.geometry
    wanted = drawn.coords if isinstance(drawn, MultiPoint) else [drawn.coords] if drawn is not None else []
    numbers = sorted({_found(partial(vertex_at, course, place)) for place in wanted})
    return [_new_tower(line, course[number], nodes[number]) for number in numbers]


def attach_towers(issue: DataIssue, parameters: dict[str, Any]) -> list[RepairEdit]:
    """Return the nearest line led through the tower; of a row of towers through the one nearest to it."""
    line = _line(issue.other_asset_id)
    course = list(line.geometry.coords)
    towers = list(Asset.objects.filter(pk__in=issue.details["assets"], vanished_at=None, kind=AssetKind.TOWER))
    if not towers:
        raise CannotRepair(_("The tower is gone. The ground is being searched again."))
    tower = min(towers, key=lambda row: (nearest_leg(course, row.geometry.coords)[2], row.pk))
    place = tower.geometry.coords
    if nearest_leg(course, place)[2] > ATTACH_M:
        raise CannotRepair(_("No line is near to the tower any more."))
    line.geometry = LineString(through(course, place, _taken_places(line, course)), srid=4326)
    return [RepairEdit(line)]


def line_along_towers(issue: DataIssue, parameters: dict[str, Any]) -> list[RepairEdit]:
    """Return a new line from tower to tower of a row, with the voltage on which all towers that state one agree."""
    towers = list(
        Asset.objects.filter(pk__in=issue.details["assets"], vanished_at=None, kind=AssetKind.TOWER, is_flyable=True).order_by("pk")
    )
    places = np.array([tower.geometry.coords for tower in towers], dtype=np.float64).reshape(-1, 2)
    order = course_of_row(places) if len(towers) > 1 else None
    if order is None or len(towers) != len(issue.details["assets"]):
        raise CannotRepair(_("The towers stand in no row any more. The ground is being searched again."))
    stated = {tuple(tower.voltages_v) for tower in towers if tower.voltages_v}
    line = Asset(
        kind=AssetKind.LINE,
        subtype="minor_line" if all(tower.subtype == "pole" for tower in towers) else "line",
        geometry=LineString(places[order].tolist(), srid=4326),
        voltages_v=list(stated.pop()) if len(stated) == 1 else [],
        tags={PLACED: "by hand"},
    )
    return [RepairEdit(line, is_new=True)]


def leave_out(issue: DataIssue, parameters: dict[str, Any]) -> list[RepairEdit]:
    """Return the issue's assets excluded from the inspection graph."""
    keys = issue.details.get("assets", [issue.asset_id])
    rows = list(Asset.objects.filter(pk__in=keys, vanished_at=None, is_flyable=True).order_by("pk"))
    if not rows:
        raise CannotRepair(_("It is not part of the graph any more."))
    for row in rows:
        row.is_flyable = False
    return [RepairEdit(row) for row in rows]


def joined_ends(issue: DataIssue, parameters: dict[str, Any]) -> list[RepairEdit]:
    """Return the end moved onto the other line, which gets a vertex there if it has none; an end with a tower is extended instead."""
    line, other = _line(issue.asset_id), _line(issue.other_asset_id)
    course, there = list(line.geometry.coords), tuple(issue.details["there"])
    end = _end(course, issue.details["end"])
    changes = []
    try:
        target = other.geometry.coords[vertex_at(other.geometry.coords, there)]
    except NoSuchVertex:
        leg, _place, metres = nearest_leg(other.geometry.coords, there)
        if metres > 1.0:
            raise CannotRepair(_("The other line runs elsewhere by now. The ground is being searched again.")) from None
        target = there
        other.geometry = LineString(with_vertices(list(other.geometry.coords), leg, [there]), srid=4326)
        changes.append(RepairEdit(other))
    line.geometry = LineString(end_moved_to(course, end, target, keeps_end=_has_support(course[end])), srid=4326)
    return [*changes, RepairEdit(line)]


def join_to_network(issue: DataIssue, parameters: dict[str, Any]) -> list[RepairEdit]:
    """Return the dead end extended straight to the nearest place of the network to which it is not connected."""
    line = _line(issue.asset_id)
    course = list(line.geometry.coords)
    end = _end(course, issue.details["end"])
    line.geometry = LineString(end_moved_to(course, end, tuple(issue.details["nearest"]), keeps_end=True), srid=4326)
    return [RepairEdit(line)]


def bridge_carries(issue: DataIssue, parameters: dict[str, Any]) -> list[RepairEdit]:
    carried = _CARRIED.get(str(parameters.get("way", "")))
    if carried is None:
        raise CannotRepair(_("Say what it carries: %(value)s.") % {"value": ", ".join(_CARRIED)})
    bridge = _asset(issue.asset_id)
    bridge.tags = bridge.tags | carried
    return [RepairEdit(bridge)]


def with_voltages(issue: DataIssue, parameters: dict[str, Any]) -> list[RepairEdit]:
    given = parameters.get("voltages_v", issue.details["offered_v"])
    if not isinstance(given, list) or not 1 <= len(given) <= MAX_VALUES:
        raise CannotRepair(_("Give 1 to %(most_values)s voltages in volts.") % {"most_values": MAX_VALUES})
    if any(isinstance(value, bool) or not isinstance(value, int) or not 0 < value <= MAX_V for value in given):
        raise CannotRepair(_("A voltage is a whole number of volts, at most %(highest_v)s.") % {"highest_v": f"{MAX_V:,}"})
    asset = _asset(issue.asset_id)
    asset.voltages_v = sorted(set(given), reverse=True)
    return [RepairEdit(asset)]


def _asset(key: int | None) -> Asset:
    asset = None if key is None else Asset.objects.filter(pk=key, vanished_at=None).first()
    if asset is None:
        raise CannotRepair(_("What the issue is about is gone. The ground is being searched again."))
    return asset


def _line(key: int | None) -> Asset:
    line = _asset(key)
    if line.kind != AssetKind.LINE:
        raise CannotRepair(_("This is no line any more. The ground is being searched again."))
    return line


def _found(search: Any) -> int:
    try:
        return int(search())
    except NoSuchVertex:
        raise CannotRepair(_("The line has changed since the issue was found. The ground is being searched again.")) from None


def _end(course: list[tuple[float, float]], place: Any) -> int:
    number = _found(lambda: vertex_at(course, place))
    if number not in (0, len(course) - 1):
        raise CannotRepair(_("The line does not end there any more. The ground is being searched again."))
    return number


def _has_support(place: tuple[float, float]) -> bool:
    return _supports_within(_box_round([place])).exists()


def _taken_places(line: Asset, course: list[tuple[float, float]]) -> FloatArray:
    """Return places of supports and of other lines' vertices, which must not move."""
    box = _box_round(course)
    places = [place.coords for place in _supports_within(box).values_list("geometry", flat=True)]
    others = Asset.objects.filter(kind=AssetKind.LINE, vanished_at=None, is_flyable=True, geometry__intersects=box).exclude(pk=line.pk)
    for other in others.values_list("geometry", flat=True):
        places.extend(other.coords)
    return np.array(places, dtype=np.float64).reshape(-1, 2)


def _supports_within(box: Polygon) -> QuerySet[Asset]:
    return Asset.objects.filter(kind=AssetKind.TOWER, vanished_at=None, is_flyable=True, geometry__intersects=box)


def _box_round(course: list[tuple[float, float]]) -> Polygon:
    """Return the course's box with a margin of a metre."""
    margin_deg = 1e-5
    (west, south), (east, north) = np.min(course, axis=0) - margin_deg, np.max(course, axis=0) + margin_deg
    box = Polygon.from_bbox((float(west), float(south), float(east), float(north)))
    box.srid = 4326
    return box


def _positions(given: Any) -> list[tuple[float, float]]:
    fault = CannotRepair(f"Give 1 to {MAX_TOWERS} positions, each as [longitude, latitude].")
    if not isinstance(given, list) or not 1 <= len(given) <= MAX_TOWERS:
        raise fault
    places = []
    for place in given:
        if not isinstance(place, list) or len(place) != 2:
            raise fault
        if any(isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value) for value in place):
            raise fault
        if abs(place[0]) > 180 or abs(place[1]) > 90:
            raise fault
        places.append((float(place[0]), float(place[1])))
    return places


def _new_tower(line: Asset, place: tuple[float, float], osm_node: int) -> RepairEdit:
    """Return a support of the line's kind. A former one at the OSM node is reused."""
    subtype = "pole" if line.subtype == "minor_line" else "tower"
    tags = {PLACED: "by hand"}
    at = Point(place, srid=4326)
    if osm_node == NO_OSM_NODE:
        return RepairEdit(Asset(kind=AssetKind.TOWER, subtype=subtype, geometry=at, tags=tags), is_new=True)
    tower = Asset.objects.filter(kind=AssetKind.TOWER, osm_type=OsmType.NODE, osm_id=osm_node).first()
    if tower is None:
        tower = Asset(kind=AssetKind.TOWER, osm_type=OsmType.NODE, osm_id=osm_node, subtype=subtype, tags=tags)
    tower.geometry, tower.vanished_at, tower.is_flyable = at, None, True
    return RepairEdit(tower, is_new=tower.pk is None)
