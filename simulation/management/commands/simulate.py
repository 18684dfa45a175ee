"""Flies the route of a file in simulation, without database, queue and sockets."""

import argparse
import json
from pathlib import Path
from typing import Any

from django.core.management import BaseCommand, CommandError, CommandParser

from planning.energy.conditions import Conditions, InvalidConditions, WindLayer
from simulation.flight.airframe import AIRFRAMES
from simulation.flight.faults import ImpossibleWeather, Weather
from simulation.flight.route_flight import InvalidRoute, fly_route, read_route

WIND_AGL_M = 10.0  # a single layer applies at all heights
MAX_BYTES = 10_000_000


class Command(BaseCommand):
    help = (
        "Flies a route in simulation: takes off at the first waypoint's ground, lands after the last, writes track, deviation, energy and "
        'assessment. ROUTE.json: {"waypoints": [{"position": [lon, lat], "altitude_relative_m": 30}], "speed_mps": 5}.'
    )
    requires_system_checks: list[str] = []

    def add_arguments(self, parser: CommandParser) -> None:
        parser.formatter_class = argparse.ArgumentDefaultsHelpFormatter
        parser.add_argument("route", type=Path, metavar="ROUTE.json")
        parser.add_argument("--wind", default="0,0", metavar="SPEED_MPS,FROM_DEG", help="at all heights")
        parser.add_argument("--gusts", type=float, default=0.0, metavar="SIGMA_MPS", help="standard deviation")
        parser.add_argument("--turbulence", type=float, default=0.0, metavar="MPS", help="Dryden turbulence of this wind at 20 ft")
        parser.add_argument("--seed", type=int, default=0, help="the same seed is the same flight")
        parser.add_argument("--airframe", choices=sorted(AIRFRAMES), default="iris")
        parser.add_argument("--battery", type=float, default=100.0, metavar="PERCENT", help="at take-off")
        parser.add_argument("--json", type=Path, required=True, metavar="OUT.json", help="where the flight goes")

    def handle(self, *args: Any, **options: Any) -> None:
        try:
            flight = fly_route(
                read_route(_read(options["route"])),
                AIRFRAMES[options["airframe"]],
                weather=Weather(_wind(options["wind"]), options["gusts"], turbulence_mps_at_20ft=options["turbulence"]),
                seed=options["seed"],
                battery_percent=_percent(options["battery"]),
            )
            written = flight.as_json()
            options["json"].write_text(json.dumps(written, allow_nan=False))
        except (OSError, InvalidRoute, InvalidConditions, ImpossibleWeather) as error:
            raise CommandError(str(error)) from error
        assessment = written["assessment"]
        self.stdout.write(f"{assessment['result']}: {written['duration_s']:.0f} s, {written['energy_wh']:.1f} Wh")
        for reason in assessment["reasons"]:
            self.stdout.write(f"  {reason}")


def _read(path: Path) -> Any:
    with path.open("rb") as file:
        content = file.read(MAX_BYTES + 1)
    if len(content) > MAX_BYTES:
        raise InvalidRoute(f"The file has more than {MAX_BYTES // 1_000_000} MB.")
    try:
        return json.loads(content)
    except (ValueError, RecursionError) as error:
        raise InvalidRoute(f"The file is no JSON: {error}") from error


def _wind(text: str) -> Conditions:
    try:
        speed_mps, from_deg = (float(part) for part in text.split(","))
    except ValueError:
        raise InvalidRoute(f"--wind is SPEED_MPS,FROM_DEG such as 8,270, not {text!r}.") from None
    return Conditions((WindLayer(WIND_AGL_M, speed_mps, from_deg % 360.0),)) if speed_mps != 0.0 else Conditions()


def _percent(value: float) -> float:
    if not 0.0 <= value <= 100.0:
        raise InvalidRoute(f"--battery must be from 0 to 100, not {value:g}.")
    return value
