"""Link model: where along its route a UAV is expected to be received again.

The route is divided into cells. A cell has reception if a report was received promptly within NEAR_M of it, in this flight, also on another
pass, or in an earlier one. While a UAV is silent, contact is expected when it reaches the next such cell ahead of its estimated position. A
cell passed in silence is thus skipped. If no cell ahead has reception, contact is expected at the route's end.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from telemetry.estimation.along_track_filter import clock_of
from telemetry.estimation.eta import end_of
from telemetry.estimation.motion import State
from telemetry.estimation.profile import FlightProfile

FloatArray = NDArray[np.float64]

CELL_M = 50.0
NEAR_M = 75.0
PROMPT_S = 10.0  # after the measurement; later reports were stored on board
SILENT_S = 10.0  # and at least this many usual intervals:
SILENT_INTERVALS = 3.0
AT_ONCE = 500  # places per batch


@dataclass(eq=False)
class LinkModel:
    """Reception of a profile's cells; `received` (cells,) grows."""

    profile: FlightProfile
    received: NDArray[np.bool_] = field(init=False)
    _along_m: FloatArray = field(init=False)
    _east_m: FloatArray = field(init=False)
    _north_m: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        count = max(int(np.ceil(self.profile.length_m / CELL_M)), 1)
        self._along_m = (np.arange(count, dtype=np.float64) + 0.5) * CELL_M
        self._east_m = np.interp(self._along_m, self.profile.along_m, self.profile.east_m)
        self._north_m = np.interp(self._along_m, self.profile.along_m, self.profile.north_m)
        self.received = np.zeros(count, dtype=np.bool_)

    def learn(self, places_m: FloatArray) -> None:
        """Mark cells near places (n, 2) of prompt reception, given as east and north in the profile's frame."""
        for begin in range(0, len(places_m), AT_ONCE):
            part = places_m[begin : begin + AT_ONCE]
            far_m = np.hypot(self._east_m[:, None] - part[:, 0], self._north_m[:, None] - part[:, 1])
            self.received |= (far_m < NEAR_M).any(axis=1)

    def expected_s(self, state: State, along_m: float, at_s: float) -> float | None:
        """Return the expected time of the next contact, as estimated at `at_s`; None if the route is over by then."""
        track = state.route
        if track is None:
            return None
        clock = clock_of(self.profile, track.along_track)
        middle_s = float(np.interp(track.along_track.nominal_s, self.profile.nominal_s, clock).mean())
        ahead = np.flatnonzero(self.received & (self._along_m - 0.5 * CELL_M > along_m))
        if len(ahead):
            begins_m = float(self._along_m[ahead[0]]) - 0.5 * CELL_M
            return max(state.report_s + float(np.interp(begins_m, self.profile.along_m, clock)) - middle_s, at_s)
        end = end_of(state, track)
        return None if end is None or end.latest_s < at_s else max(end.at_s, at_s)
