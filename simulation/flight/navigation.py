"""Where the UAV takes itself to be: by GPS where it is; without, by dead reckoning, which drifts."""

import math
from random import Random

DRIFT_MPS = 0.3  # of each axis, drawn when the fix is lost: what a compass, an airspeed and tilt leave after the wind has been learnt
WANDER_MPS = 0.03  # by which that changes in the first second; it grows with the root of time
CATCH_UP_S = 1.0  # until a new fix is believed


class Navigation:
    """`error_m` is what its position is off to east and north."""

    def __init__(self, seed: int) -> None:
        self._random = Random(seed)
        self._drift_mps: tuple[float, float] | None = None
        self.error_m = (0.0, 0.0)

    def step(self, dt_s: float, *, is_gps_lost: bool) -> None:
        if not is_gps_lost:
            self._drift_mps = None
            if self.error_m != (0.0, 0.0):
                kept = math.exp(-dt_s / CATCH_UP_S)
                east, north = (part * kept for part in self.error_m)
                self.error_m = (east, north) if math.hypot(east, north) > 1e-3 else (0.0, 0.0)
            return
        draw = self._random.gauss
        if self._drift_mps is None:
            self._drift_mps = (draw(0.0, DRIFT_MPS), draw(0.0, DRIFT_MPS))
        east_mps, north_mps = self._drift_mps
        wander_mps = WANDER_MPS * math.sqrt(dt_s)
        self._drift_mps = (east_mps + draw(0.0, wander_mps), north_mps + draw(0.0, wander_mps))
        self.error_m = (self.error_m[0] + self._drift_mps[0] * dt_s, self.error_m[1] + self._drift_mps[1] * dt_s)
