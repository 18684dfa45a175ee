"""The air of a set of conditions, as simulated UAVs fly in it."""

from simulation.flight.faults import MAX_GUSTS_MPS, MAX_TURBULENCE_MPS, Weather
from simulation.rehearsing.weather_scenario import Sky


def weather_of(sky: Sky) -> Weather:
    return Weather(
        conditions=sky.conditions,
        gusts_mps=min(sky.gusts_mps, MAX_GUSTS_MPS),
        turbulence_mps_at_20ft=min(sky.turbulence_mps_at_20ft, MAX_TURBULENCE_MPS),
    )
