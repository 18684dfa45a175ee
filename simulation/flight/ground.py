"""The ground that a simulated UAV flies over."""

from dataclasses import dataclass
from typing import Protocol

from inspection.geodesy import LonLat


class Ground(Protocol):
    """Anything that knows how high the ground lies above sea level [m]; NaN where it does not."""

    def elevation_m(self, position: LonLat) -> float: ...


@dataclass(frozen=True, slots=True)
class FlatGround:
    """The same height everywhere."""

    height_m: float = 0.0

    def elevation_m(self, position: LonLat) -> float:
        return self.height_m
