"""Where along its route a UAV can be expected to be heard again.

The route is divided into cells. A cell is heard if a report was received there promptly, within NEAR_M of it: one of this flight, also on
another pass of the same place, or one of an earlier flight. While a UAV is silent, contact is expected when it reaches the next heard cell
that lies ahead of where it is estimated to be now; so a stretch through which it was not heard, though others were, is given up as it is
passed. Where no cell ahead was ever heard, at the route's end.
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
PROMPT_S = 10.0  # after it was measured: what comes later was kept on board
SILENT_S = 10.0  # and at least so many usual intervals:
SILENT_INTERVALS = 3.0
AT_ONCE = 500  # places


@dataclass(eq=False)
class LinkModel:
    """What is known of a profile's cells; `received` (cells,) grows."""

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
        """Something was heard promptly from these places, (n, 2), east and north in the profile's frame."""
        for begin in range(0, len(places_m), AT_ONCE):
            part = places_m[begin : begin + AT_ONCE]
            far_m = np.hypot(self._east_m[:, None] - part[:, 0], self._north_m[:, None] - part[:, 1])
            self.received |= (far_m < NEAR_M).any(axis=1)

    def expected_s(self, state: State, along_m: float, at_s: float) -> float | None:
        """When it is heard again, by what is believed at `at_s`; None where its route is over by then."""
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
