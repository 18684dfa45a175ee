"""Detects a UAV on the ground away from its plan: crashed, or landed by itself. Only a user closes this alert, with a reason."""

import math
from collections.abc import Iterable

from inspection.geodesy import LonLat
from telemetry.alerting.detection import CRITICAL, Detection
from telemetry.alerting.detector import Detector
from telemetry.alerting.detector_input import DetectorInput
from telemetry.alerting.detector_state import DetectorState, position_of
from telemetry.alerting.route_line import RouteLine
from telemetry.alerting.surroundings import IssuedOrder

CODE = "down-off-plan"
WORDS = (
    "%(uav)s is on the ground %(metres)s m from where its flight begins or ends, last at %(place)s: it has crashed, or landed by itself."
)
AWAY_M = 30.0  # from the planned places on the ground; above the error of GPS and of a manual landing
SETS_OFF = frozenset({"start", "take-off", "resume"})
ORDERED_TO = frozenset({"land"})  # commanded from here: no alert
FELL_WITHIN_S = 10.0  # before it was on the ground
GIVEN_AFTER_S = 2.0  # tolerance between clocks and reports


def detect(inputs: DetectorInput) -> Iterable[Detection] | None:
    """Return the detection; None without one, so that an open alert stays open."""
    if inputs.is_accounted_for:
        return None
    away = _away(inputs)
    return None if away is None else [detection(inputs.uav.name, inputs.uav.flight, *away)]


def is_down_away(inputs: DetectorInput) -> bool:
    """Return whether it is on the ground away from its plan, and no user has closed that alert."""
    return not inputs.is_accounted_for and (any(code == CODE for code, _ in inputs.open_levels) or _away(inputs) is not None)


def has_ended(inputs: DetectorInput) -> bool:
    """Return whether its flight is over: it came down away from its plan during the flight, and has been disarmed there since.

    Returns False for a UAV that came down at a planned place, even if carried away later: it can start again. Also for one that was
    commanded to land, is silent, or was down before monitoring began.
    """
    detector_state, model, newest = inputs.detector_state, inputs.model, inputs.uav.newest
    if model is None or newest is None or detector_state.down_s is None or detector_state.down_at is None or not inputs.is_disarmed:
        return False
    has_stayed = newest.measured_s - detector_state.down_s >= DETECTOR.raise_after_s or inputs.is_open(CODE, str(inputs.uav.flight))
    if not has_stayed or _away(inputs) is None:
        return False
    return away_from_plan_m(model.line, detector_state.down_at, model.rally_points) >= AWAY_M


def _away(inputs: DetectorInput) -> tuple[LonLat, float] | None:
    """Return its position and the distance from its plan [m]; None if it is not down off plan."""
    newest, model = inputs.uav.newest, inputs.model
    if newest is None or model is None or not inputs.is_known_down or not _was_started(inputs):
        return None
    position = position_of(newest)
    if position is None:
        return None
    away_m = away_from_plan_m(model.line, position, model.rally_points)
    return None if away_m < AWAY_M else (position, away_m)


def detection(name: str, flight: int, position: LonLat, away_m: float) -> Detection:
    values = {"uav": name, "metres": round(away_m), "place": degrees_text(position)}
    details = {"position": [position.lon, position.lat], "away_m": round(away_m, 1), "flight": flight}
    return Detection(CODE, CRITICAL, WORDS, values, subject=str(flight), details=details)


def degrees_text(position: LonLat) -> str:
    """Return a position as text for people and map programs: latitude first, as in ISO 6709, to 1 m."""
    north, east = "N" if position.lat >= 0.0 else "S", "E" if position.lon >= 0.0 else "W"
    return f"{abs(position.lat):.5f}° {north}, {abs(position.lon):.5f}° {east}"


def away_from_plan_m(line: RouteLine, position: LonLat, rally_points: Iterable[LonLat] = ()) -> float:
    """Return the distance to the nearest planned place on the ground, rally points included [m]."""
    stands = [
        line.vertices[0],
        line.vertices[-1],
        *(line.vertices[place] for place in line.charges_at),
        *map(line.east_north, rally_points),
    ]
    here = line.east_north(position)
    return min(math.dist(here, place) for place in stands)


def _was_started(inputs: DetectorInput) -> bool:
    order = inputs.order
    if order is not None and order.kind in ORDERED_TO and _could_land(inputs.detector_state, order):
        return False
    return inputs.detector_state.was_in_flight or (order is not None and order.kind in SETS_OFF and order.done_s is not None)


def _could_land(detector_state: DetectorState, order: IssuedOrder) -> bool:
    """Return whether the landing can be the effect of the order: it did not fall, and was not down before the order."""
    if detector_state.down_s is None:
        return True
    fell = detector_state.fell_s is not None and detector_state.down_s - detector_state.fell_s <= FELL_WITHIN_S
    return not fell and (order.given_s is None or order.given_s <= detector_state.down_s + GIVEN_AFTER_S)


DETECTOR = Detector(CODE, detect, raise_after_s=2.0, clear_after_s=0.0, needs_flight=False)
