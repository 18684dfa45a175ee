"""What a witness would say of flown tracks, by the judges' own plane and hills and the rows of the database: no code of the assessment."""

from typing import Any

import numpy as np

from inspection.models import Asset, NoFlyZone
from simulation.assessment.flown import AssessedRoute
from tests.exact_geometry import segment_meets_polygon
from tests.missions.oracles.terrain_oracle import Hills
from tests.missions.plane import east_north

PASSED_M = 2.0
HIT_M = 1.0
OFF_GROUND_M = 3.0  # higher than that it is not just taking off or landing
MIN_TOWER_M = 20.0  # of one whose height nobody has written down


def _plane(places: Any, origin: Any) -> Any:
    return np.array([east_north(origin, place) for place in places]).reshape(-1, 2)


def _away(at: Any, start: Any, end: Any) -> float:
    """From a place to a straight line between two, in as many dimensions as they have."""
    by = end - start
    share = np.clip(np.dot(at - start, by) / max(float(np.dot(by, by)), 1e-12), 0.0, 1.0)
    return float(np.linalg.norm(at - start - share * by))


def waypoints_missed(route: AssessedRoute) -> list[str]:
    """Those that no straight line between two moments comes within PASSED_M of."""
    missed = []
    for flown in route.flights:
        assert flown.track is not None
        for waypoint in flown.flight.waypoints:
            flat = np.column_stack([_plane(flown.track.position, waypoint.position), flown.track.relative_m - waypoint.altitude_relative_m])
            near = np.flatnonzero(np.linalg.norm(flat, axis=1) < 50.0)
            away_m = min((_away(np.zeros(3), flat[row], flat[min(row + 1, len(flat) - 1)]) for row in near), default=np.inf)
            if away_m > PASSED_M:
                missed.append(f"{route.name} passed waypoint {waypoint.sequence} at {away_m:.1f} m")
    return missed


def zones_entered(route: AssessedRoute) -> list[str]:
    """At whatever height and time: these zones have no limits."""
    found = []
    for zone in NoFlyZone.objects.all():
        west, south, east, north = zone.geometry.extent
        rings = [[tuple(place[:2]) for place in ring] for polygon in zone.geometry.coords for ring in polygon]
        for track in route.tracks:
            at = track.position[track.is_in_air]
            beside = (at[:, 0] >= west) & (at[:, 0] <= east) & (at[:, 1] >= south) & (at[:, 1] <= north)
            for row in np.flatnonzero(beside[:-1] | beside[1:]).tolist():
                if segment_meets_polygon(tuple(at[row]), tuple(at[row + 1]), rings):
                    found.append(f"{route.name} enters {zone.name}")
                    break
    return found


def things_hit(route: AssessedRoute, hills: Hills) -> list[str]:
    """The ground, towers, and wires straight from tower to tower; of the higher part of the flight."""
    found = []
    for track in route.tracks:
        above_m = track.amsl_m - hills.metres(track.position)
        high = track.is_in_air & (track.relative_m > OFF_GROUND_M)
        if (above_m[high & ~track.is_coming_down] < OFF_GROUND_M).any():
            found.append(f"{route.name} comes within {OFF_GROUND_M} m of the ground")
        places, amsl_m = track.position[high], track.amsl_m[high]
        origin = places.mean(axis=0)
        flat = _plane(places, origin)
        for start, end, tops_m, name in _standing(places, hills):
            ends = _plane([start, end], origin)
            by, length2 = ends[1] - ends[0], float(((ends[1] - ends[0]) ** 2).sum())
            shares = np.clip((flat - ends[0]) @ by / max(length2, 1e-12), 0.0, 1.0)
            beside_m = np.linalg.norm(flat - ends[0] - shares[:, None] * by, axis=1)
            if ((beside_m < HIT_M) & (amsl_m < tops_m[0] + shares * (tops_m[1] - tops_m[0]) + HIT_M)).any():
                found.append(f"{route.name} hits {name}")
    return found


def _standing(places: Any, hills: Hills) -> list[tuple[Any, Any, Any, str]]:
    """Each tower as a line to itself, and the wires between the towers of a line, with their tops above the sea."""
    (west, south), (east, north) = places.min(axis=0) - 0.01, places.max(axis=0) + 0.01
    towers = {
        asset.osm_id: (asset.centre.coords, asset.height_m or MIN_TOWER_M)
        for asset in Asset.objects.filter(kind="tower", vanished_at=None)
        if west <= asset.centre.x <= east and south <= asset.centre.y <= north
    }
    found = [(at, at, hills.metres([at, at]) + height_m, f"tower {key}") for key, (at, height_m) in towers.items()]
    for line in Asset.objects.filter(kind="line", vanished_at=None):
        for one, other in zip(line.node_osm_ids, line.node_osm_ids[1:], strict=False):
            if one in towers and other in towers:
                (start, start_m), (end, end_m) = towers[one], towers[other]
                found.append((start, end, hills.metres([start, end]) + np.array([start_m, end_m]), f"wire {line.osm_id}"))
    return found
