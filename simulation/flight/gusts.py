"""Gusts that last: a Gauss-Markov process for each axis."""

import math
from random import Random

VERTICAL_SHARE = 0.25  # near the ground gusts have little room to go up and down


class Gusts:
    """Each step the air's velocity beside its mean, north, east and down [m/s], with the given deviation and time constant.

    The process is exact for any step (G. E. Uhlenbeck, L. S. Ornstein, On the Theory of the Brownian Motion, 1930): its deviation does not
    depend on how finely it is stepped.
    """

    def __init__(self, seed: int) -> None:
        self._random = Random(seed)
        self._ned = (0.0, 0.0, 0.0)

    def step(self, dt_s: float, deviation_mps: float, time_s: float) -> tuple[float, float, float]:
        if deviation_mps == 0.0 and self._ned == (0.0, 0.0, 0.0):
            return self._ned
        kept = math.exp(-dt_s / time_s)
        fresh = deviation_mps * math.sqrt(1.0 - kept * kept)
        north, east, down = self._ned
        draw = self._random.gauss
        self._ned = (
            kept * north + fresh * draw(0.0, 1.0),
            kept * east + fresh * draw(0.0, 1.0),
            kept * down + fresh * VERTICAL_SHARE * draw(0.0, 1.0),
        )
        return self._ned
