"""Detects a UAV in a no-fly zone in force, or on course for one. Each zone has one alert."""

import math
from collections.abc import Iterator

import shapely

from inspection.geodesy import LonLat
from telemetry.alerting.detection import CRITICAL, WARNING, Detection
from telemetry.alerting.detector import Detector
from telemetry.alerting.detector_input import DetectorInput
from telemetry.alerting.detector_state import position_of
from telemetry.alerting.route_line import RouteLine
from telemetry.alerting.surroundings import NearZone

CODE = "zone"
INSIDE = "%(uav)s is in the no-fly zone %(zone)s."
AHEAD = "%(uav)s will be in the no-fly zone %(zone)s in %(seconds)s s."
STEPS = 10  # of the prediction
SLOW_MPS = 0.5


def detect(inputs: DetectorInput) -> list[Detection] | None:
    if inputs.fresh is None:
        return None
    position = position_of(inputs.fresh)
    if position is None:
        return None
    if not inputs.zones:
        return []
    point = shapely.Point(position)
    ways = list(_ways(inputs, position))
    agl_m = inputs.agl_m
    low_m, high_m = _heights_ahead(inputs, agl_m)
    found = []
    for zone in inputs.zones:
        if zone.applies_at(inputs.now_s) and zone.reaches(agl_m, agl_m) and zone.polygon.intersects(point):
            found.append(_detection(inputs, zone, 0.0))
            continue
        if not zone.reaches(low_m, high_m):
            continue
        in_s = min((seconds for way in ways if (seconds := _reached_in_s(way, zone, inputs)) is not None), default=None)
        if in_s is not None:
            found.append(_detection(inputs, zone, in_s))
    return found


def _detection(inputs: DetectorInput, zone: NearZone, in_s: float) -> Detection:
    values = {"uav": inputs.uav.name, "zone": zone.name} | ({"seconds": round(in_s)} if in_s > 0.0 else {})
    details = {"zone": zone.zone_id, "in_s": round(in_s, 1)}
    return Detection(
        CODE, WARNING if in_s > 0.0 else CRITICAL, AHEAD if in_s > 0.0 else INSIDE, values, subject=str(zone.zone_id), details=details
    )


def _heights_ahead(inputs: DetectorInput, agl_m: float | None) -> tuple[float | None, float | None]:
    """Return the lowest and highest height above ground until the horizon, by its climb and by its route."""
    reported, place, model = inputs.uav.newest, inputs.place, inputs.model
    if agl_m is None or reported is None:
        return None, None
    heights_m = [agl_m, agl_m - (reported.measurement.velocity_down_mps or 0.0) * inputs.limits.zone_ahead_s]
    if place is not None and model is not None and inputs.flies_mission:
        speed_mps = math.hypot(reported.measurement.velocity_north_mps or 0.0, reported.measurement.velocity_east_mps or 0.0)
        heights_m += model.line.agl_between(place.along_m, place.along_m + speed_mps * inputs.limits.zone_ahead_s)
    return min(heights_m), max(heights_m)


def _ways(inputs: DetectorInput, position: LonLat) -> Iterator[list[tuple[float, float]]]:
    """Yield the predicted positions at each step, in lon/lat: by its velocity, and along its route."""
    reported, horizon_s = inputs.uav.newest, inputs.limits.zone_ahead_s
    if reported is None:
        return
    north_mps, east_mps = reported.measurement.velocity_north_mps or 0.0, reported.measurement.velocity_east_mps or 0.0
    speed_mps = math.hypot(north_mps, east_mps)
    if speed_mps > SLOW_MPS:
        degree_north_m = 111_195.0
        degree_east_m = degree_north_m * max(math.cos(math.radians(position.lat)), 1e-6)
        steps = [horizon_s * step / STEPS for step in range(1, STEPS + 1)]
        yield [
            (position.lon + east_mps * seconds / degree_east_m, position.lat + north_mps * seconds / degree_north_m) for seconds in steps
        ]
    place, model = inputs.place, inputs.model
    if place is not None and model is not None and inputs.flies_mission and place.across_m <= inputs.limits.off_route_m:
        pace_mps = max(speed_mps, 1.0)
        yield [_degrees(model.line, place.along_m + pace_mps * horizon_s * step / STEPS) for step in range(1, STEPS + 1)]


def _degrees(line: RouteLine, along_m: float) -> tuple[float, float]:
    east, north = line.at(along_m)
    origin = line.frame.origin
    return origin.lon + east / line.frame.metres_per_degree_east, origin.lat + north / line.frame.metres_per_degree_north


def _reached_in_s(way: list[tuple[float, float]], zone: NearZone, inputs: DetectorInput) -> float | None:
    """Return the end of the first step that touches the zone while it applies [server seconds]; None if none does.

    Steps are equal times on the UAV's clock.
    """
    if not zone.polygon.intersects(shapely.LineString(way)):
        return None
    step_s = inputs.limits.zone_ahead_s / STEPS / inputs.link.clock_rate
    before = way[0]
    for step, here in enumerate(way, 1):
        touches = zone.polygon.intersects(shapely.LineString([before, here]) if here != before else shapely.Point(here))
        if touches and zone.applies_between(inputs.now_s + (step - 1) * step_s, inputs.now_s + step * step_s):
            return step * step_s
        before = here
    return None


DETECTOR = Detector(CODE, detect, raise_after_s=1.0, clear_after_s=5.0)
