"""Converts a scenario's conditions to the weather of simulated UAVs."""

from simulation.flight.faults import MAX_GUSTS_MPS, MAX_TURBULENCE_MPS, Weather
from simulation.rehearsing.weather_scenario import WeatherScenario


def weather_of(scenario: WeatherScenario) -> Weather:
    return Weather(
        conditions=scenario.conditions,
        gusts_mps=min(scenario.gusts_mps, MAX_GUSTS_MPS),
        turbulence_mps_at_20ft=min(scenario.turbulence_mps_at_20ft, MAX_TURBULENCE_MPS),
    )
