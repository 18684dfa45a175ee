"""Runs a MAVLink gateway until it is stopped by SIGTERM."""

import asyncio
import errno
import logging
import time
from argparse import ArgumentParser
from typing import Any

from django.core.management.base import BaseCommand, CommandError

from operation.program import program_begins
from telemetry.gateway.figures import figures_of
from telemetry.gateway.options import InvalidUdpAddress, options_of_settings
from telemetry.gateway.process import Gateway

logger = logging.getLogger(__name__)

PORT_INTERVAL_S = 5.0
ENDS_WITHIN_S = 9.5


class Command(BaseCommand):
    requires_system_checks = ()  # checked at set-up; a killed process restarts without delay
    help = (
        "Run a MAVLink gateway: vehicles talk to it by UDP and TCP, it stores what they report and brings them their commands. "
        "Any number can run at once; each UAV is served by one of them."
    )

    def add_arguments(self, parser: ArgumentParser) -> None:
        parser.add_argument("--udp", metavar="HOST:PORT,…", help="where to listen; empty for nowhere (SPANWISE_GATEWAY_UDP)")
        parser.add_argument("--tcp", metavar="HOST:PORT,…", help="the same for connections (SPANWISE_GATEWAY_TCP)")
        parser.add_argument("--name", help="the same at each start, and no other gateway's (SPANWISE_GATEWAY_NAME)")

    def handle(self, *_: Any, udp: str | None, tcp: str | None, name: str | None, **__: Any) -> None:
        try:
            options = options_of_settings(udp=udp, tcp=tcp, name=name)
        except InvalidUdpAddress as error:
            raise CommandError(str(error)) from error
        while True:
            try:
                asyncio.run(_run(Gateway(options), self.stdout.write))
            except OSError as error:
                if error.errno != errno.EADDRINUSE:
                    raise CommandError(f"The gateway cannot listen: {error}") from error
                logger.error("the gateway waits for a port that somebody else holds: %s", error)
                time.sleep(PORT_INTERVAL_S)
            else:
                return


async def _run(gateway: Gateway, report: Any) -> None:
    gateway.stop_on_signals(after_s=ENDS_WITHIN_S)
    with figures_of(gateway):
        program_begins("gateway", gateway.not_ready)
        await gateway.run(on_listening=lambda names: report(f"listening on {', '.join(names)}"))
