"""What bars every path to a target: a part of the network that no UAV gets to, or the first zone on the path that there would be."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from inspection.geodesy import LonLat, distance_m
from operation.reasons import Reason
from planning.airspace import Airspace, NamedZone, airspace_on, named_zone
from planning.assignment.candidate_plan import CandidatePlan
from planning.assignment.unassigned import LOCKED
from planning.connection_points import FloatArray, Terminal, paths_between
from planning.context import ResolvedTarget
from planning.plan import UnassignedTarget

BARRED = {"no_path", "no_path_for_uavs"}  # codes of reasons


def with_barriers(found: CandidatePlan, left_out: Sequence[UnassignedTarget]) -> list[UnassignedTarget]:
    """The targets left out, each that no UAV has a path to with what bars that."""
    barred = {item.target for item in left_out if item.why[0].code in BARRED and not item.is_for(LOCKED.code)}
    starts = [found.request.uavs[uav].position for uav in found.uavs]
    barriers = barriers_of([target for target in found.drawing.targets if target.target in barred], starts, found.airspace)
    return [
        replace(item, why=(item.why[0], barriers[item.target].why, *item.why[1:])) if item.target in barriers else item for item in left_out
    ]


@dataclass(frozen=True)
class Barrier:
    """What bars every path; the zone, if that is one."""

    why: Reason
    zone: NamedZone | None = None


def barriers_of(targets: Sequence[ResolvedTarget], starts: Sequence[LonLat], airspace: Airspace) -> dict[int, Barrier]:
    """Return what bars the targets, by their places in the request, from UAVs at the starts; without those for which neither is so."""
    if not targets or not starts:
        return {}
    free = airspace_on(airspace.context, np.zeros(len(airspace.context.zones), dtype=bool), is_by_length=True)
    paths = paths_between(
        free.graph,
        free.leg_zones,
        starts=[Terminal(start) for start in starts],
        entries=[Terminal(target.course[0], target.asset) for target in targets],
        exits=[Terminal(target.course[-1], target.asset) for target in targets],
        rules=free.access,
    )
    barriers: dict[int, Barrier] = {}
    for number, target in enumerate(targets):
        lengths_m = paths.from_start_m[:, number]
        nearest = int(lengths_m.argmin())
        if not np.isfinite(lengths_m[nearest]):
            away_m = float(distance_m(np.array(starts), np.tile(target.course[0], (len(starts), 1))).min())
            barriers[target.target] = Barrier(Reason("not_connected", {"away_km": _rounded(away_m / 1_000.0)}))
            continue
        line = np.concatenate([np.array([starts[nearest]]), free.graph.position[paths.out(nearest, number)], np.array([target.course[0]])])
        zone = _first_zone(line, airspace)
        if zone is not None:
            barriers[target.target] = Barrier(Reason("barred_by_zone", zone.params), zone)
    return barriers


def _rounded(kilometres: float) -> float:
    return round(kilometres, 1 if kilometres < 100.0 else None)


def _first_zone(line: FloatArray, airspace: Airspace) -> NamedZone | None:
    """line: the shortest path that there would be without zones."""
    met = np.flatnonzero(airspace.leg_zones.meets(line[:-1], line[1:], airspace.access.zone_clearance_m))
    for leg in met.tolist():
        zone = airspace.leg_zones.first_met(LonLat(*line[leg]), LonLat(*line[leg + 1]))
        if zone is not None:
            return named_zone(*zone)
    return None
