"""Reads the photos of logged flights from their tlog files."""

from argparse import ArgumentParser
from typing import Any

from django.core.management.base import BaseCommand

from telemetry.models import FlightLog
from telemetry.services.captures import store_captures_of_log


class Command(BaseCommand):
    help = "Stores the photos that flight logs report and that are not stored yet. May run again at any time."

    def add_arguments(self, parser: ArgumentParser) -> None:
        parser.add_argument("--uav", type=int, help="id of a UAV; all without it")

    def handle(self, *args: Any, uav: int | None, **options: Any) -> None:
        logs = FlightLog.objects.order_by("started_at")
        for log in logs if uav is None else logs.filter(uav=uav):
            try:
                counts = store_captures_of_log(log)
            except OSError as error:
                self.stderr.write(f"{log.path}: {error}")
                continue
            self.stdout.write(f"{log.path}: {counts.photos} photos stored, {counts.known} reports known")
