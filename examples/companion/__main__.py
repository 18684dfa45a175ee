"""python -m examples.companion: a companion with the kinematic stand-in for an autopilot."""

import argparse
import os
import time
from datetime import UTC, datetime
from pathlib import Path

from examples.companion.client import Companion
from examples.companion.journal import Journal
from examples.companion.kinematic import KinematicAutopilot
from examples.companion.link import HttpLink

TOKEN = "SPANWISE_UAV_TOKEN"  # noqa: S105 - the name of the variable


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m examples.companion", description=__doc__)
    parser.add_argument("--server", required=True, help="address of Spanwise, such as https://spanwise.example")
    parser.add_argument("--token-file", type=Path, help=f"file with the UAV's token; without it the variable {TOKEN}")
    parser.add_argument("--journal", type=Path, default=Path("companion.sqlite"), help="what outlives a crash")
    parser.add_argument("--at", required=True, help="where the UAV stands: longitude,latitude")
    parser.add_argument("--ground-amsl-m", type=float, default=0.0, help="height of the ground there above mean sea level")
    parser.add_argument("--poll-every-s", type=float, default=5.0)
    parser.add_argument("--report-every-s", type=float, default=10.0)
    parser.add_argument("--plain-http", action="store_true", help="also to another machine without TLS: only on a closed network")
    asked = parser.parse_args()
    token = asked.token_file.read_text().strip() if asked.token_file else os.environ.get(TOKEN, "")
    if not token:
        parser.error(f"a token is needed: --token-file, or {TOKEN}")
    longitude, latitude = (float(part) for part in asked.at.split(","))
    companion = Companion(
        HttpLink(asked.server, token, plain_http=asked.plain_http),
        Journal(asked.journal),
        KinematicAutopilot((longitude, latitude), ground_amsl_m=asked.ground_amsl_m),
        poll_every_s=asked.poll_every_s,
        report_every_s=asked.report_every_s,
        notify=lambda words: print(f"{datetime.now(UTC):%H:%M:%S} {words}", flush=True),
    )
    while True:
        begun_s = time.monotonic()
        companion.step(time.time())
        time.sleep(max(0.0, min(1.0, asked.poll_every_s / 5) - (time.monotonic() - begun_s)))


if __name__ == "__main__":
    main()
