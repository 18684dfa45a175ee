"""A sane world in one line: lines, a railway, a bridge, a graph; and requests to plan on it.

rail    r --------- r --------- r      56.010
             bridge #
line    t0 - t1 - t2 - t3 - t4 - t5    56.000   towers 250 m apart
UAVs        x                          55.995
       10.000                 10.020
"""

from dataclasses import dataclass
from typing import Any

from inspection.geodesy import LonLat
from inspection.models import Asset, NoFlyZone
from inspection.services import build_graph, mark_ground_changed
from missions.services import PlanRequest, TargetRequest, UavRequest
from planning.problem import Objective
from planning.request import EndAction
from tests.inspection import ground

TOWER_LONS = (10.000, 10.004, 10.008, 10.012, 10.016, 10.020)
LINE_LAT = 56.0
UAV_AT = LonLat(10.001, 55.995)


@dataclass(frozen=True)
class World:
    towers: list[Asset]
    line: Asset
    railway: Asset
    bridge: Asset


def world(**tower_facts: Any) -> World:
    towers = [ground.tower((lon, LINE_LAT), **tower_facts) for lon in TOWER_LONS]
    line = power_line(towers, voltages_v=[110_000])
    railway = ground.railway((10.0, 56.01), (10.010, 56.01), (10.020, 56.01))
    bridge = ground.bridge((10.008, 56.006))
    rebuild()
    return World(towers, line, railway, bridge)


def power_line(towers: list[Asset], **facts: Any) -> Asset:
    return ground.line(*[tower.centre.coords for tower in towers], node_osm_ids=[tower.osm_id for tower in towers], **facts)


def island(lon: float = 10.3) -> list[Asset]:
    """Two towers on a line of their own, 18 km to the east."""
    towers = [ground.tower((lon, LINE_LAT)), ground.tower((lon + 0.004, LINE_LAT))]
    power_line(towers)
    rebuild()
    return towers


def rebuild() -> None:
    mark_ground_changed()
    build_graph()


def zone_around(centre: tuple[float, float], half_deg: float = 0.001, *, with_graph: bool = True, name: str = "Airport") -> NoFlyZone:
    zone = ground.zone(centre, half_deg, name=name)
    mark_ground_changed()
    if with_graph:
        build_graph()
    return zone


def uav(
    position: tuple[float, float] = UAV_AT,
    *,
    name: str = "Tern",
    max_range_m: float | None = None,
    end_action: EndAction = EndAction.HOVER,
    **wishes: Any,
) -> UavRequest:
    return UavRequest(name, LonLat(*position), max_range_m, 12.0, end_action, **wishes)


def request(
    *targets: TargetRequest | Asset,
    uavs: tuple[UavRequest, ...] | None = None,
    objective: Objective = Objective.TOTAL,
    return_to_start: bool = False,
    **wishes: Any,
) -> PlanRequest:
    asked = tuple(target if isinstance(target, TargetRequest) else TargetRequest(target.pk) for target in targets)
    return PlanRequest((uav(),) if uavs is None else uavs, asked, objective, return_to_start, **wishes)
