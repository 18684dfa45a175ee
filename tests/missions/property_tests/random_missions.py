"""Random zones and random missions on a real region."""

import random

import numpy as np
import shapely
from django.contrib.gis.geos import GEOSGeometry, MultiPolygon

from inspection.geodesy import LonLat
from inspection.models import Asset, AssetKind, NoFlyZone
from inspection.selectors import current_graph
from inspection.services import build_graph, mark_ground_changed
from missions.services import BaseRequest, PlanRequest, TargetRequest, UavRequest
from planning.energy.performance import Performance
from planning.problem import Objective
from planning.request import NO_BATTERY, EndAction

ZONES = 40
AMPLE = Performance(battery_wh=50_000.0)  # where the least energy is wished for, every UAV has a battery; this one binds nobody


def put_random_zones(seed: int) -> None:
    """Forty irregular polygons of 0.1 to 2 km around places of the network, some with a hole; and the graph cleared of them."""
    NoFlyZone.objects.all().delete()
    mark_ground_changed()
    build_graph()
    places = np.array(current_graph().position)
    draw = np.random.default_rng(seed)
    zones = []
    for number, (lon, lat) in enumerate(places[draw.integers(0, len(places), ZONES)] + draw.normal(0, 0.004, (ZONES, 2))):
        angle = np.sort(draw.uniform(0, 2 * np.pi, draw.integers(4, 12)))
        reach_deg = draw.uniform(0.001, 0.02) * draw.uniform(0.4, 1.0, len(angle))
        polygon = shapely.Polygon(np.column_stack([lon + reach_deg * np.cos(angle), lat + reach_deg * np.sin(angle)]))
        if number % 5 == 0 and polygon.is_valid:
            polygon = polygon.difference(polygon.centroid.buffer(0.0005, quad_segs=2))
        if polygon.geom_type == "Polygon" and polygon.is_valid and polygon.area > 0:
            geometry = MultiPolygon(GEOSGeometry(memoryview(shapely.to_wkb(polygon)), srid=4326), srid=4326)
            zones.append(NoFlyZone(identifier=f"random-{number}", name=f"Zone {number}", geometry=geometry))
    NoFlyZone.objects.bulk_create(zones)
    mark_ground_changed()
    build_graph()


class Region:
    """Draws missions on what is in the database."""

    def __init__(self) -> None:
        self.assets = {
            kind: list(Asset.objects.filter(kind=kind, vanished_at=None).order_by("pk").values_list("pk", flat=True)) for kind in AssetKind
        }
        self.places = [tuple(place) for place in current_graph().position.tolist()]
        shortest = Asset.objects.filter(kind__in=[AssetKind.LINE, AssetKind.RAILWAY], length_m__lt=20_000, vanished_at=None)
        self.stretches = list(shortest.order_by("pk").values_list("pk", flat=True))

    def mission(self, draw: random.Random) -> PlanRequest:
        """One or two UAVs, one to four targets within some 30 km, every option as the dice fall."""
        centre = draw.choice(self.places)
        near = [place for place in draw.sample(self.places, min(400, len(self.places))) if _is_near(place, centre)] or [centre]
        nearby = list(
            Asset.objects.filter(
                centre__within=GEOSGeometry(shapely.box(centre[0] - 0.3, centre[1] - 0.2, centre[0] + 0.3, centre[1] + 0.2).wkt, srid=4326)
            )
            .order_by("pk")
            .values_list("pk", "kind")
        )
        objective = draw.choice(list(Objective))
        uavs = tuple(
            UavRequest(
                f"UAV {number}",
                _moved(draw, draw.choice(near), 0.03),
                draw.choice([None, None, 15_000.0, 40_000.0]),
                12.0,
                draw.choice(list(EndAction)),
                performance=AMPLE if objective is Objective.ENERGY else NO_BATTERY,
            )
            for number in range(draw.randint(1, 2))
        )
        targets = tuple(self._target(draw, near, nearby) for _ in range(draw.randint(1, 4)))
        bases = tuple(BaseRequest(f"Base {number}", _moved(draw, draw.choice(near), 0.02)) for number in range(2))
        return PlanRequest(uavs, targets, objective, draw.random() < 0.3, bases=bases)

    def _target(self, draw: random.Random, near: list[tuple[float, float]], nearby: list[tuple[int, str]]) -> TargetRequest:
        if not nearby or draw.random() < 0.15:
            return TargetRequest(None, _moved(draw, draw.choice(near), 0.1 if draw.random() < 0.2 else 0.02))
        asset, kind = draw.choice(nearby)
        if kind in {AssetKind.TOWER, AssetKind.BRIDGE}:
            return TargetRequest(asset)
        if draw.random() < 0.3 and asset in self.stretches:
            return TargetRequest(asset)
        course = Asset.objects.only("geometry").get(pk=asset).geometry.coords
        return TargetRequest(asset, LonLat(*draw.choice(course)[:2]))


def _is_near(place: tuple[float, float], centre: tuple[float, float]) -> bool:
    return abs(place[0] - centre[0]) < 0.3 and abs(place[1] - centre[1]) < 0.2


def _moved(draw: random.Random, place: tuple[float, float], by_deg: float) -> LonLat:
    return LonLat(place[0] + draw.uniform(-by_deg, by_deg), place[1] + draw.uniform(-by_deg, by_deg))
