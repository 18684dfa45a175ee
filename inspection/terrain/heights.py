"""One height in three references: above ground, above sea level, above take-off. What is not known is NaN, never a number."""

import numpy as np

from inspection.geodesy.wgs84 import FloatArray

REFERENCES = ("AGL", "AMSL", "RELATIVE")


class UnknownReference(ValueError):
    """A height that does not say from where it is counted is no height."""


def amsl_m(values_m: FloatArray, reference: str, *, ground_amsl_m: FloatArray, take_off_amsl_m: float) -> FloatArray:
    """Heights above sea level [m] of values counted from `reference`; NaN where ground or take-off is needed and not known.

    values_m and ground_amsl_m have shape (n,). Raises UnknownReference.
    """
    return np.asarray(values_m + _zero_of(reference, ground_amsl_m, take_off_amsl_m), dtype=np.float64)


def counted_from(heights_amsl_m: FloatArray, reference: str, *, ground_amsl_m: FloatArray, take_off_amsl_m: float) -> FloatArray:
    """The inverse of amsl_m."""
    return np.asarray(heights_amsl_m - _zero_of(reference, ground_amsl_m, take_off_amsl_m), dtype=np.float64)


def _zero_of(reference: str, ground_amsl_m: FloatArray, take_off_amsl_m: float) -> FloatArray:
    """Where a reference counts from, above sea level."""
    if reference == "AGL":
        return ground_amsl_m
    if reference == "AMSL":
        return np.zeros_like(ground_amsl_m)
    if reference == "RELATIVE":
        return np.full_like(ground_amsl_m, take_off_amsl_m)
    raise UnknownReference(f"A height is counted from {', '.join(REFERENCES)}, not from {reference!r}.")
