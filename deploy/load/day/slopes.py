"""How fast something grows, and how sure that is: a straight line through samples whose faults hang together."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

S_PER_H = 3_600.0
GROWS, FLAT, NOT_DECIDED = "grows", "flat", "not decided"
SURE = 0.95
MAX_HANGING = 0.98


@dataclass(frozen=True)
class Slope:
    """In percent of the mean, an hour; `error` is its standard error, and 95 of 100 times the truth lies within `bound` of it."""

    percent_per_h: float
    error: float
    bound: float
    mean: float

    def verdict(self, bar: float) -> str:
        """GROWS where it is above the bar for sure, FLAT where it is below it for sure."""
        if self.percent_per_h - self.bound > bar:
            return GROWS
        return FLAT if self.percent_per_h + self.bound < bar else NOT_DECIDED

    def __str__(self) -> str:
        return f"{self.percent_per_h:+.2f} ± {self.bound:.2f}"


def slope(at_s: NDArray[np.float64], values: NDArray[np.float64]) -> Slope:
    """Least squares; both of shape (n,), n at least 4.

    A sample that is above the line is mostly followed by another one above it, as memory is taken in steps. With the correlation r of
    neighbours n samples say as much as n (1 - r) / (1 + r) that are independent: the usual correction for autoregressive residuals (Santer
    et al. 2000, J. Geophys. Res. 105, 7337).
    """
    hours = (at_s - at_s.mean()) / S_PER_H
    mean = float(values.mean())
    if mean == 0.0 or not hours.any():
        return Slope(0.0, 0.0, 0.0, mean)
    spread = float((hours**2).sum())
    steepness = float((hours * (values - mean)).sum()) / spread
    rest = values - mean - steepness * hours
    power = float((rest**2).sum())
    hanging = float((rest[1:] * rest[:-1]).sum()) / power if power > 0 else 0.0
    hanging = min(max(hanging, 0.0), MAX_HANGING)
    independent = max(len(values) * (1.0 - hanging) / (1.0 + hanging), 3.0)
    error = float(np.sqrt(power / (independent - 2.0) / spread))
    errors = float(student.ppf(0.5 + SURE / 2.0, independent - 2.0))
    return Slope(100.0 * steepness / mean, 100.0 * error / mean, 100.0 * errors * error / mean, mean)
