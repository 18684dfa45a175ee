"""What the flights of a route took out of their batteries, and what was left when each was over."""

from dataclasses import dataclass

from simulation.verdict.flown import FlownRoute


@dataclass(frozen=True)
class FlightEnergy:
    """One flight: watt-hours used, and percent left at its end; lowest_percent on the way."""

    flight: int
    used_wh: float
    left_percent: float
    lowest_percent: float


def energy_of(route: FlownRoute) -> list[FlightEnergy]:
    """Of the flights that were flown."""
    return [
        FlightEnergy(
            number,
            float(flown.track.used_wh[-1]),
            float(flown.track.battery_percent[-1]),
            float(flown.track.battery_percent.min()),
        )
        for number, flown in enumerate(route.flights)
        if flown.track is not None and len(flown.track)
    ]
