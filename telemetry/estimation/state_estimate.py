"""State estimate of a UAV at one moment, in a flat frame around its take-off."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

CHI2_95 = 5.991  # 95 % ellipse of a two-dimensional normal distribution
NORMAL_95 = 1.960
# Radii in standard deviations of five equally weighted rings that spread the isotropic uncertainty around each place.
_RINGS = np.sqrt(-2.0 * np.log(1.0 - np.array([0.1, 0.3, 0.5, 0.7, 0.92])))


@dataclass(frozen=True, eq=False)
class StateEstimate:
    """Means with their uncertainty.

    `covariance` (2, 2) is of east and north [m2]; `gate2` is the squared Mahalanobis distance that contains 95 %. The others are standard
    deviations. `nominal_s` is the reading of its profile's clock, None off a route.
    """

    east_m: float
    north_m: float
    height_m: float | None
    east_mps: float
    north_mps: float
    up_mps: float
    covariance: FloatArray
    gate2: float
    height_sd_m: float
    speed_sd_mps: float
    nominal_s: float | None = None

    @property
    def speed_mps(self) -> float:
        return float(np.hypot(self.east_mps, self.north_mps))


def isotropic_covariance(variance_m2: float) -> FloatArray:
    return np.eye(2) * variance_m2


def gate2_of(
    east_m: FloatArray, north_m: FloatArray, weight: FloatArray, isotropic_variance_m2: float, covariance: FloatArray, held: float = 0.95
) -> float:
    """Return the squared Mahalanobis distance that contains a share `held` of places around the mean, each with isotropic variance."""
    inverse = np.linalg.inv(covariance)
    angle = np.arange(len(east_m)) * 2.399_963  # the golden angle, so that neighbours get different directions
    found, parts = [], []
    for number, ring in enumerate(_RINGS):
        lie = angle + number * 1.256_637
        east = east_m + ring * np.sqrt(isotropic_variance_m2) * np.cos(lie)
        north = north_m + ring * np.sqrt(isotropic_variance_m2) * np.sin(lie)
        found.append(inverse[0, 0] * east**2 + 2.0 * inverse[0, 1] * east * north + inverse[1, 1] * north**2)
        parts.append(weight)
    distance2, share = np.concatenate(found), np.concatenate(parts)
    order = np.argsort(distance2)
    total = np.cumsum(share[order])
    return float(distance2[order][min(int(np.searchsorted(total, held * total[-1])), len(order) - 1)])
