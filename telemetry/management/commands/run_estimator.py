"""Runs an estimator until it is stopped by SIGTERM."""

import os
import signal
import threading
from argparse import ArgumentParser
from typing import Any

from django.core.management.base import BaseCommand

from operation.program import program_begins
from telemetry.watch.options import options_of_settings
from telemetry.watch.process import Watch

ENDS_WITHIN_S = 9.5


class Command(BaseCommand):
    requires_system_checks = ()  # checked at set-up; a killed process restarts without delay
    help = (
        "Run a watch: it estimates where each UAV on a mission is, once a second. "
        "Any number can run at once; each UAV is estimated by one of them, and taken over when it is gone."
    )

    def add_arguments(self, parser: ArgumentParser) -> None:
        parser.add_argument("--name", help="the same at each start, and no other watch's (SPANWISE_ESTIMATOR_NAME)")
        parser.add_argument("--most-uavs", type=int, help="that it holds at once (SPANWISE_ESTIMATOR_MAX_UAVS)")

    def handle(self, *_: Any, name: str | None, most_uavs: int | None, **__: Any) -> None:
        watch = Watch(options_of_settings(name=name, most_uavs=most_uavs))

        def stop(*_: Any) -> None:
            watch.stop()
            last_resort = threading.Timer(ENDS_WITHIN_S, os._exit, [1])  # exits even if the database does not respond
            last_resort.daemon = True
            last_resort.start()

        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, stop)
        self.stdout.write(f"watching as {watch.options.holder}")
        program_begins("estimator")
        watch.run()
