"""Detectors: one cause each, with its delays, in the order of evaluation: those that suppress others come first.

Each has a module of its own with the same names: CODE, its texts, `detect` and DETECTOR.
"""

from telemetry.alerting.detector import Detector
from telemetry.alerting.detectors import (
    battery,
    converging,
    down,
    gps,
    height_off,
    link,
    mode_changed,
    no_progress,
    off_route,
    other_mission,
    weather,
    zone,
)

DETECTORS: tuple[Detector, ...] = tuple(
    module.DETECTOR
    for module in (link, gps, down, mode_changed, other_mission, zone, converging, off_route, height_off, no_progress, battery, weather)
)
CODES = tuple(detector.code for detector in DETECTORS)
