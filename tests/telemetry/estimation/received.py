"""What is heard of a flight: reports at intervals, with the errors of GPS and barometer, late, lost and out of order."""

import math
import random

import numpy as np

from mavlink.decoding.measurement import Measurement
from telemetry.estimation.report import Report
from tests.telemetry.estimation.truth import STEP_S, Truth

GPS_SHARED_M, GPS_SHARED_S, GPS_OWN_M = 1.2, 150.0, 0.4
BARO_SHARED_M, BARO_SHARED_S, BARO_OWN_M = 0.9, 300.0, 0.2
SPEED_M = 0.12
LOST, LATE = 0.03, 0.02


def reports_of(truth: Truth, every_s: float, seed: int, *, begun_s: float = 0.0) -> list[Report]:
    """In the order of their arrival. begun_s: the flight's start since the epoch."""
    chance = random.Random(f"heard {seed} {every_s}")
    received = []
    error = [chance.gauss(0.0, GPS_SHARED_M), chance.gauss(0.0, GPS_SHARED_M), chance.gauss(0.0, BARO_SHARED_M)]
    at_s = chance.uniform(0.0, min(every_s, 2.0))
    while at_s < truth.duration_s:
        for axis, (size_m, lasts_s) in enumerate([(GPS_SHARED_M, GPS_SHARED_S)] * 2 + [(BARO_SHARED_M, BARO_SHARED_S)]):
            keep = math.exp(-every_s / lasts_s)
            error[axis] = keep * error[axis] + math.sqrt(1.0 - keep**2) * chance.gauss(0.0, size_m)
        delay_s = chance.uniform(0.05, 0.6) + (chance.uniform(2.0, 20.0) if chance.random() < LATE else 0.0)
        if chance.random() >= LOST:
            received.append(_report(truth, at_s, begun_s, delay_s, error, chance))
        at_s += every_s * chance.uniform(0.95, 1.05)
    return sorted(received, key=lambda report: report.received_s)


def _report(truth: Truth, at_s: float, begun_s: float, delay_s: float, error: list[float], chance: random.Random) -> Report:
    east, north, up, v_east, v_north, v_up = truth.at(at_s)
    reported = [
        east + error[0] + chance.gauss(0.0, GPS_OWN_M),
        north + error[1] + chance.gauss(0.0, GPS_OWN_M),
        up + error[2] + chance.gauss(0.0, BARO_OWN_M),
    ]
    lon, lat = truth.frame.to_degrees(np.array([reported[:2]]))[0]
    row = min(int(at_s / STEP_S), len(truth.modes) - 1)
    speed = math.hypot(v_east, v_north)
    measurement = Measurement(
        longitude_deg=float(lon),
        latitude_deg=float(lat),
        altitude_relative_m=reported[2],
        altitude_amsl_m=reported[2] + 40.0,
        velocity_north_mps=float(v_north) + chance.gauss(0.0, SPEED_M),
        velocity_east_mps=float(v_east) + chance.gauss(0.0, SPEED_M),
        velocity_down_mps=-float(v_up) + chance.gauss(0.0, SPEED_M),
        heading_deg=math.degrees(math.atan2(v_east, v_north)) % 360.0 if speed > 1.0 else None,
        mode=truth.modes[row],
        is_armed=truth.armed[row] if truth.armed else True,
        is_in_air=truth.in_air[row],
        waypoint_sequence=truth.sequence[row],
    )
    return Report(begun_s + at_s, begun_s + at_s + delay_s, measurement)
