"""Runs a simulator until it is stopped by SIGTERM."""

import os
import signal
import sys
import threading
from argparse import ArgumentParser
from typing import Any

from django.core.management.base import BaseCommand, CommandError

from operation.program import program_begins
from simulation.simulator.options import options_of_settings
from simulation.simulator.process import Simulator, figures_of
from simulation.vehicle_endpoint.radio import InvalidStationAddress

ENDS_WITHIN_S = 9.5
SWITCH_S = 0.001  # between threads: at ten times real time a step is due every 4 ms


class Command(BaseCommand):
    requires_system_checks = ()  # checked at set-up; a killed process restarts without delay
    help = (
        "Run a simulator: it flies simulated UAVs in real time, those of missions through the gateway and those of the pool at ports of "
        "their own. Any number can run at once; each simulation is flown by one of them, and begins anew at another when that is gone."
    )

    def add_arguments(self, parser: ArgumentParser) -> None:
        parser.add_argument("--name", help="the same at each start, and no other simulator's (SPANWISE_SIMULATOR_NAME)")
        parser.add_argument("--most-uavs", type=int, help="that it flies, each as often as its speed (SPANWISE_SIMULATOR_MAX_UAVS)")
        parser.add_argument("--gateway", metavar="HOST:PORT", help="where missions' UAVs connect (SPANWISE_SIMULATOR_GATEWAY)")

    def handle(self, *_: Any, name: str | None, most_uavs: int | None, gateway: str | None, **__: Any) -> None:
        try:
            simulator = Simulator(options_of_settings(name=name, most_uavs=most_uavs, gateway=gateway))
        except InvalidStationAddress as error:
            raise CommandError(str(error)) from error

        def stop(*_: Any) -> None:
            simulator.stop()
            last_resort = threading.Timer(ENDS_WITHIN_S, os._exit, [1])  # exits even if the database does not respond
            last_resort.daemon = True
            last_resort.start()

        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, stop)
        sys.setswitchinterval(SWITCH_S)
        self.stdout.write(f"simulating as {simulator.options.holder}")
        self.stdout.flush()
        with figures_of(simulator):
            program_begins("simulator")
            simulator.run()
