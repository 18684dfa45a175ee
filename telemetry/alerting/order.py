"""All detectors, in the order in which they look: what hides others comes before them."""

from telemetry.alerting.detector import Detector
from telemetry.alerting.detectors import link

DETECTORS: tuple[Detector, ...] = (link.DETECTOR,)
CODES = tuple(detector.code for detector in DETECTORS)
