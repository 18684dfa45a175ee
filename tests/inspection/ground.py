"""Assets and zones in one line each, around 10 E 56 N."""

from itertools import count
from typing import Any

from django.contrib.gis.geos import LineString, MultiPolygon, Point, Polygon

from inspection.models import Asset, NoFlyZone

_numbers = count(1)

Position = tuple[float, float]


def _asset(kind: str, geometry: Any, centre: Position, **facts: Any) -> Asset:
    voltages_v = facts.pop("voltages_v", [])
    values = {"osm_id": next(_numbers), "voltages_v": voltages_v, "max_voltage_v": max(voltages_v, default=None)} | facts
    return Asset.objects.create(kind=kind, geometry=geometry, centre=Point(centre, srid=4326), **values)


def tower(position: Position = (10.0, 56.0), **facts: Any) -> Asset:
    return _asset("tower", Point(position, srid=4326), position, **{"subtype": "tower", "osm_type": "n"} | facts)


def line(*positions: Position, **facts: Any) -> Asset:
    path = positions or ((10.0, 56.0), (10.01, 56.01))
    return _asset("line", LineString(path, srid=4326), path[0], **{"subtype": "line", "osm_type": "w", "length_m": 1_500.0} | facts)


def railway(*positions: Position, **facts: Any) -> Asset:
    path = positions or ((10.0, 56.0), (10.01, 55.99))
    return _asset("railway", LineString(path, srid=4326), path[0], **{"subtype": "rail", "osm_type": "w"} | facts)


def bridge(centre: Position = (10.0, 56.0), **facts: Any) -> Asset:
    return _asset("bridge", MultiPolygon(square(centre, 0.001), srid=4326), centre, **{"subtype": "area", "osm_type": "w"} | facts)


def square(centre: Position, half_deg: float) -> Polygon:
    lon, lat = centre
    return Polygon.from_bbox((lon - half_deg, lat - half_deg, lon + half_deg, lat + half_deg))


def zone(centre: Position = (10.0, 56.0), half_deg: float = 0.01, **facts: Any) -> NoFlyZone:
    values = {"identifier": f"zone-{next(_numbers)}", "name": "Airport"} | facts
    return NoFlyZone.objects.create(geometry=MultiPolygon(square(centre, half_deg), srid=4326), **values)
