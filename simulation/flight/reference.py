"""The point that the UAV follows: it moves along a course as fast as the course and the governor let it."""

import math
from collections.abc import Sequence

from simulation.flight.course import Piece, Vector

NEAR_ENOUGH_M = 0.01
SLOWEST_MPS = 0.1  # so that an end is reached and not only approached


class Reference:
    """`place`, `along`, `speed_mps` and `gain_mps2` (of that speed) after each step; `is_at_end` once it stands at the last point."""

    def __init__(self, pieces: Sequence[Piece], speed_mps: float, acceleration_mps2: float) -> None:
        self._pieces = pieces
        self._number, self._s_m = 0, 0.0
        self._acceleration_mps2 = acceleration_mps2
        self.speed_mps, self.gain_mps2 = speed_mps, 0.0
        self.is_at_end = not pieces
        self._is_told = False
        self.place, self.along, self._curve = pieces[0].at(0.0) if pieces else ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.0)

    def step(self, dt_s: float, share: float) -> list[int]:
        """On by one step, at this share of the speed that may be flown. Returns the marks that were passed."""
        marks: list[int] = []
        if self.is_at_end:
            self.speed_mps, self.gain_mps2 = 0.0, 0.0
            return marks
        piece = self._pieces[self._number]
        left_m = piece.length_m - self._s_m
        in_time_mps = math.sqrt(piece.end_mps**2 + 2.0 * self._acceleration_mps2 * max(left_m, 0.0))
        wanted_mps = max(min(piece.fastest_mps * share, in_time_mps), min(SLOWEST_MPS, share * SLOWEST_MPS))
        change_mps = self._acceleration_mps2 * dt_s
        # It slows as hard as the course asks for: it was drawn so that this is no more than what is gained each second.
        speed_mps = (
            min(wanted_mps, self.speed_mps + change_mps)
            if wanted_mps > self.speed_mps
            else max(wanted_mps, self.speed_mps - 1.5 * change_mps)
        )
        self.gain_mps2 = (speed_mps - self.speed_mps) / dt_s
        self._s_m += 0.5 * (speed_mps + self.speed_mps) * dt_s
        self.speed_mps = speed_mps
        while True:
            piece = self._pieces[self._number]
            is_past = self._s_m >= piece.length_m - NEAR_ENOUGH_M
            if piece.mark is not None and not self._is_told and (is_past or (piece.radius_m and self._s_m >= 0.5 * piece.length_m)):
                marks.append(piece.mark)
                self._is_told = True
            if not is_past:
                break
            if self._number + 1 == len(self._pieces):
                self.is_at_end, self._s_m = True, piece.length_m
                self.speed_mps = 0.0
                break
            self._s_m = max(self._s_m - piece.length_m, 0.0)
            self._number += 1
            self._is_told = False
        self.place, self.along, self._curve = self._pieces[self._number].at(self._s_m)
        return marks

    def acceleration(self, lead_s: float) -> Vector:
        """What the course asks for [m/s²]: to the side as it will in `lead_s`, since an attitude takes that long, and along it now."""
        gain = self.gain_mps2
        u, v, w = self.along
        number, s_m = self._number, self._s_m + self.speed_mps * lead_s
        while s_m > self._pieces[number].length_m and number + 1 < len(self._pieces):
            s_m -= self._pieces[number].length_m
            number += 1
        piece = self._pieces[number]
        if piece.radius_m == 0.0 or self.is_at_end:
            return gain * u, gain * v, gain * w
        a, b, c = piece.bend(min(s_m, piece.length_m))
        side = self.speed_mps**2 / piece.radius_m
        return gain * u + side * a, gain * v + side * b, gain * w + side * c

    @property
    def end(self) -> Vector:
        return self._pieces[-1].at(self._pieces[-1].length_m)[0] if self._pieces else self.place
