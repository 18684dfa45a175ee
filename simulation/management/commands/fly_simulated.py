"""Flies simulated UAVs with MAVLink until it is stopped. Needs no database."""

import gc
import json
import signal
import sys
import threading
from argparse import ArgumentParser, RawDescriptionHelpFormatter
from dataclasses import asdict
from pathlib import Path
from typing import Any

from django.core.management.base import BaseCommand, CommandError

from inspection.geodesy import LonLat
from simulation.flight.airframe import AIRFRAMES
from simulation.flight.plant import FlatGround
from simulation.vehicle_endpoint.fleet import MAX_SPEED, MIN_SPEED, InvalidSpeed, SimulatedFleet, WrongOrder, change_of, weather_of
from simulation.vehicle_endpoint.launch import MAX_SYSTEM_ID, Launch, fleet_of, in_a_row
from simulation.vehicle_endpoint.radio import InvalidStationAddress, address_of
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot

MAX_UAVS = 200
KEY_LENGTH = 32


class Command(BaseCommand):
    help = (
        "Fly simulated UAVs that speak MAVLink to a gateway or to a ground station. They stand where --at says and wait to be told.\n\n"
        "  manage.py fly_simulated --at 10.40,55.40 --to 127.0.0.1:14550                  one UAV for QGroundControl or MAVProxy\n"
        "  manage.py fly_simulated --at 10.40,55.40 --count 5 --first-system 11 --speed 5   five in a row, five times as fast\n\n"
        "With --orders lines of JSON on the standard input change weather, faults and speed in flight:\n"
        '  {"system": 11, "weather": {"wind": [8, 270], "gusts_mps": 2, "turbulence_mps": 5, "temperature_c": 15}}\n'
        '  {"faults": {"link_lost_for_s": 20, "gps_lost_for_s": 30, "battery_wh_left": 5, "motor_failed": 2, "stuck_item": 4,\n'
        '              "clock_offset_s": -3600}, "speed": 2}'
    )
    requires_system_checks: list[str] = []

    def create_parser(self, prog_name: str, subcommand: str, **kwargs: Any) -> Any:
        return super().create_parser(prog_name, subcommand, formatter_class=RawDescriptionHelpFormatter, **kwargs)

    def add_arguments(self, parser: ArgumentParser) -> None:
        parser.add_argument("--at", action="append", required=True, metavar="LON,LAT", help="where a UAV stands; once for each UAV")
        parser.add_argument("--count", type=int, default=1, help="with one --at: so many UAVs in a row to the east")
        parser.add_argument("--spacing", type=float, default=10.0, metavar="M", help="between them [m]")
        parser.add_argument("--ground", type=float, default=0.0, metavar="M", help="height of the flat ground above sea level [m]")
        parser.add_argument("--to", action="append", default=[], metavar="HOST:PORT", help="who is talked to by UDP; may be repeated")
        parser.add_argument("--listen", metavar="HOST:PORT", help="where the first UAV listens; the others at the ports that follow")
        parser.add_argument("--first-system", type=int, default=1, help="MAVLink system id of the first UAV; the others follow")
        parser.add_argument("--keys", type=Path, help='JSON file {"system id": "64 hexadecimal digits"} of the signing keys')
        parser.add_argument(
            "--autopilot-type",
            choices=[autopilot_type.value for autopilot_type in SimulatedAutopilot],
            default=SimulatedAutopilot.PX4.value,
        )
        parser.add_argument("--airframe", choices=sorted(AIRFRAMES), default="iris")
        parser.add_argument("--battery", type=float, default=100.0, metavar="PERCENT")
        parser.add_argument("--wind", default="0,0", metavar="SPEED_MPS,FROM_DEG")
        parser.add_argument("--gusts", type=float, default=0.0, metavar="SIGMA_MPS")
        parser.add_argument("--turbulence", type=float, default=0.0, metavar="MPS", help="wind at 20 ft that makes it")
        parser.add_argument("--speed", type=float, default=1.0, help=f"simulated seconds a second, {MIN_SPEED:g} to {MAX_SPEED:g}")
        parser.add_argument("--seed", type=int, default=0, help="of the first UAV; the others follow")
        parser.add_argument("--seconds", type=float, help="end after so many simulated seconds")
        parser.add_argument("--orders", action="store_true", help="take changes from the standard input; its end ends nothing")

    def handle(self, **options: Any) -> None:
        try:
            fleet = fleet_of(_launches(options), speed=options["speed"])
        except (InvalidStationAddress, WrongOrder, InvalidSpeed, ValueError) as error:
            raise CommandError(str(error)) from error
        except OSError as error:
            raise CommandError(f"No socket: {error}") from error
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, lambda *_: fleet.end())
        for flying in fleet.uavs:
            self.stdout.write(
                json.dumps({"system": flying.system, "port": flying.radio.port, "autopilot_type": flying.autopilot_type.value})
            )
        self.stdout.flush()
        if options["orders"]:
            threading.Thread(target=self._take_orders, args=(fleet,), daemon=True).start()
        gc.freeze()  # existing objects stay: collecting them again and again would delay steps
        seconds = options["seconds"]
        uav = fleet.uavs[0].uav
        report = fleet.run(lambda: seconds is not None and uav.now_s >= seconds)
        fleet.close()
        self.stdout.write(json.dumps(asdict(report)))

    def _take_orders(self, fleet: SimulatedFleet) -> None:
        for line in sys.stdin:
            if not line.strip():
                continue
            try:
                fleet.post(change_of(line))
            except (WrongOrder, InvalidSpeed) as error:
                self.stderr.write(f"not done: {error}")


def _launches(options: dict[str, Any]) -> list[Launch]:
    """Return the launches. Raises InvalidStationAddress, WrongOrder, and ValueError with a message."""
    places = [_place(text) for text in options["at"]]
    if options["count"] != 1:
        if len(places) != 1:
            raise ValueError("--count goes with one --at.")
        places = in_a_row(places[0], options["count"], options["spacing"])
    first = options["first_system"]
    if not 1 <= len(places) <= MAX_UAVS or first < 1 or first + len(places) - 1 > MAX_SYSTEM_ID:
        raise ValueError(f"1 to {MAX_UAVS} UAVs with system ids from 1 to {MAX_SYSTEM_ID} can be flown.")
    keys = _keys(options["keys"])
    wind = [float(part) for part in options["wind"].split(",")]
    weather = weather_of({"wind": wind, "gusts_mps": options["gusts"], "turbulence_mps": options["turbulence"]})
    listens_at = address_of(options["listen"]) if options["listen"] else None
    return [
        Launch(
            system=first + number,
            home=place,
            airframe=options["airframe"],
            autopilot_type=SimulatedAutopilot(options["autopilot_type"]),
            key=keys.get(first + number),
            seed=options["seed"] + number,
            battery_percent=options["battery"],
            ground=FlatGround(options["ground"]),
            weather=weather,
            talks_to=[address_of(text) for text in options["to"]],
            listens_at=None if listens_at is None else (listens_at[0], listens_at[1] + number),
        )
        for number, place in enumerate(places)
    ]


def _place(text: str) -> LonLat:
    parts = text.split(",")
    try:
        lon, lat = (float(part) for part in parts)
    except ValueError as error:
        raise ValueError(f"{text!r} is not LON,LAT.") from error
    return LonLat(lon, lat)


def _keys(path: Path | None) -> dict[int, bytes]:
    """Return the keys by system id. Error messages do not include the file's content."""
    if path is None:
        return {}
    try:
        keys = {int(system): bytes.fromhex(key) for system, key in json.loads(path.read_text()).items()}
    except (OSError, ValueError, AttributeError, TypeError) as error:
        raise ValueError(f"{path.name} is no file of keys.") from error
    if any(len(key) != KEY_LENGTH for key in keys.values()):
        raise ValueError(f"{path.name}: a key has {2 * KEY_LENGTH} hexadecimal digits.")
    return keys
