"""Detects an unreliable position: no fix, a weak fix, or a jump."""

import math

from inspection.geodesy import LonLat
from telemetry.alerting.detection import ACTS, CRITICAL, HOLD, LAND, TAKE_OVER, WARNING, Detection, acts
from telemetry.alerting.detector import Detector
from telemetry.alerting.detector_input import DetectorInput
from telemetry.alerting.detector_state import position_of
from telemetry.estimation.report import Report

CODE = "gps"
NO_FIX = "%(uav)s: no GPS fix. %(own)s"
NO_POSITION = "%(uav)s: telemetry without position. %(own)s"
JUMPED = "The position of %(uav)s has jumped by %(metres)s m."
FEW = "%(uav)s sees %(satellites)s satellites only."
WEAK = "The position of %(uav)s is weak: its HDOP is %(hdop)s."
# The autopilot's own reaction: ArduCopter's EKF failsafe (FS_EKF_ACTION 1, after 1 s above FS_EKF_THRESH); PX4's failsafe of a lost
# position (Commander, blind descend), after EKF2_NOAID_TOUT without aiding of EKF2.
OWN_ARDUPILOT = "ArduPilot usually lands by itself within seconds (FS_EKF_ACTION) and drifts with the wind."
OWN_PX4 = "PX4 usually descends by itself 5 s after it lost its position (EKF2_NOAID_TOUT) and drifts with the wind."
OWN_UNKNOWN = "What its autopilot does by itself is not known."
OWN = {"ardupilot": OWN_ARDUPILOT, "px4": OWN_PX4}
FIX_IN_SPACE = 3
MORE_SATELLITES, CLEAR_SHARE = 1, 0.85  # to clear: satellites above the limit; share of the HDOP limit
MIN_JUMP_M = 50.0
JUMP_LASTS_S = 6.0
BETWEEN_S = 5.0  # reports farther apart show no jump: a UAV may have flown the distance


def detect(inputs: DetectorInput) -> list[Detection] | None:
    fresh, limits = inputs.fresh, inputs.limits
    if fresh is None:
        return None
    reported, is_open = fresh.measurement, inputs.is_open(CODE)
    jump_m = _jump_m(inputs, fresh)
    found: tuple[str, str, dict[str, object]] | None = None
    if reported.gps_fix is not None and reported.gps_fix < FIX_IN_SPACE:
        found = CRITICAL, NO_FIX, {}
    elif position_of(fresh) is None:
        found = CRITICAL, NO_POSITION, {}
    elif jump_m is not None:
        found = WARNING, JUMPED, {"metres": round(jump_m)}
    elif reported.satellites is not None and reported.satellites < limits.least_satellites + (MORE_SATELLITES if is_open else 0):
        found = WARNING, FEW, {"satellites": reported.satellites}
    elif reported.hdop is not None and reported.hdop > limits.most_hdop * (CLEAR_SHARE if is_open else 1.0):
        found = WARNING, WEAK, {"hdop": f"{reported.hdop:.1f}"}
    if found is None:
        return []
    level, words, values = found
    is_lost = level == CRITICAL
    if is_lost:
        values["own"] = OWN.get(inputs.link.autopilot, OWN_UNKNOWN)
    answers = acts(LAND, TAKE_OVER, uav_id=inputs.uav.uav_id) if is_lost else acts(HOLD, uav_id=inputs.uav.uav_id)
    details = {
        ACTS: answers,
        "gps_fix": reported.gps_fix,
        "satellites": reported.satellites,
        "hdop": reported.hdop,
        "jump_m": jump_m and round(jump_m),
    }
    return [Detection(CODE, level, words, {"uav": inputs.uav.name, **values}, details=details)]


def _jump_m(inputs: DetectorInput, fresh: Report) -> float | None:
    """Return the distance of its last jump while that is recent. Updates the detector state."""
    detector_state = inputs.detector_state
    before = detector_state.before
    if before is not None and detector_state.jumped_s != fresh.received_s:
        here, there = position_of(fresh), position_of(before)
        seconds = fresh.measured_s - before.measured_s
        if here is not None and there is not None and 0.0 < seconds <= BETWEEN_S:
            metres = _flat_m(there, here)
            if metres >= max(MIN_JUMP_M, inputs.limits.jump_mps * _own_s(before, fresh, inputs.link.clock_rate)):
                detector_state.jumped_s, detector_state.jump_m = fresh.received_s, metres
    is_news = detector_state.jumped_s is not None and inputs.now_s - detector_state.jumped_s <= JUMP_LASTS_S
    return detector_state.jump_m if is_news else None


def _own_s(before: Report, after: Report, clock_rate: float) -> float:
    """Return the seconds between two measurements on the UAV's own clock: as reported, else by its estimated rate."""
    if before.boot is not None and after.boot is not None and before.boot.stream == after.boot.stream:
        return after.boot.clock_s - before.boot.clock_s
    return (after.measured_s - before.measured_s) * clock_rate


def _flat_m(start: LonLat, end: LonLat) -> float:
    north = (end.lat - start.lat) * 111_195.0
    return math.hypot(north, (end.lon - start.lon) * 111_195.0 * math.cos(math.radians(start.lat)))


DETECTOR = Detector(CODE, detect, raise_after_s=3.0, clear_after_s=5.0)
