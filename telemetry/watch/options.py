"""Options of an estimator."""

from dataclasses import dataclass

from django.conf import settings

from workspace.leases import HolderOptions, holder_name

LEASE_S = 3.0  # a killed estimator's UAVs are taken over within this and one round


@dataclass(frozen=True, kw_only=True)
class EstimatorOptions(HolderOptions):
    """Options; it holds at most `most_uavs` UAVs."""

    most_uavs: int
    lease_s: float = LEASE_S


def options_of_settings(*, name: str | None = None, most_uavs: int | None = None) -> EstimatorOptions:
    """Return the options; without a name one is made for this process, so that two estimators on a host differ."""
    return EstimatorOptions(
        name=holder_name(name or settings.ESTIMATOR_NAME), most_uavs=settings.ESTIMATOR_MAX_UAVS if most_uavs is None else most_uavs
    )
