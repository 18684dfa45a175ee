"""The weather as the model feels it: wind of the height with gusts on it, turbulence, and warmth, told step by step."""

import math

from planning.energy.conditions import LAPSE_K_PER_M, SEA_LEVEL_K
from simulation.flight.gusts import Gusts
from simulation.flight.plant import GUIDANCE_STEP_S, Plant
from simulation.flight.weather import Weather

KELVIN = 273.15


class Air:
    """`wind_ned_mps` is the velocity of the air at the UAV, without what Dryden turbulence adds to it."""

    def __init__(self, plant: Plant, weather: Weather, *, ground_m: float, seed: int) -> None:
        self._plant = plant
        self._gusts = Gusts(seed)
        self._ground_m = ground_m
        self.wind_ned_mps = (0.0, 0.0, 0.0)
        self.weather = weather
        self.change(weather)

    def change(self, weather: Weather) -> None:
        self.weather = weather
        self._plant.set_turbulence(weather.turbulence_mps_at_20ft)
        standard_k = SEA_LEVEL_K - LAPSE_K_PER_M * self._ground_m
        self._plant.set_temperature(weather.conditions.temperature_c + KELVIN - standard_k)

    def step(self, agl_m: float) -> None:
        weather = self.weather
        east_mps, north_mps = weather.conditions.wind_at(agl_m) if weather.conditions.wind and math.isfinite(agl_m) else (0.0, 0.0)
        gust = self._gusts.step(GUIDANCE_STEP_S, weather.gusts_mps, weather.gust_time_s)
        wind = (north_mps + gust[0], east_mps + gust[1], gust[2])
        if wind != self.wind_ned_mps:
            self.wind_ned_mps = wind
            self._plant.set_wind(*wind)
