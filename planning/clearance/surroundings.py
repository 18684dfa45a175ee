"""What a way home is checked against: zones, the ground, and what stands or hangs beside it."""

from dataclasses import dataclass

import numpy as np

from inspection.network.spans import Spans, spans_between
from planning.clearance.zone_clearance import Margins, ZoneFacts
from planning.trajectory.heights import GroundHeights

SAMPLE_SPACING_M = 50.0  # how densely the ground under a way home is looked at
NOTHING_STANDS = spans_between(np.empty((0, 2)), np.empty((0, 2)), np.empty(0), np.empty(0))


@dataclass(frozen=True, eq=False)
class Surroundings:
    """ground_heights_m is None where flat ground is assumed."""

    zones: ZoneFacts
    margins: Margins
    ground_heights_m: GroundHeights | None = None
    spans: Spans = NOTHING_STANDS
