"""The mixed working day of deploy/load beside what is broken on purpose, and what must be true of it afterwards."""

import json
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from deploy.load.day.playing import ALL, Playing, playing
from deploy.load.installation import Installation
from scripts.places import PROJECT_DIR, CannotStart
from tests.chaos.experiment import Course
from tests.chaos.jobs import one_of
from tests.chaos.site import Site, shipped, users_of

SIZES = {False: {"people": 60, "uavs": 60, "companions": 8, "users": 40}, True: {"people": 20, "uavs": 20, "companions": 3, "users": 16}}
SETTLES_S = 180
QUICK = {"SPANWISE_LARGE_PLAN_SEARCH_S": "1", "SPANWISE_PLAN_RATE": "100/second"}


@dataclass
class Day:
    """An installation at work; `site` asks it beside the people of the day."""

    site: Site
    folder: Path
    users: int
    in_air: tuple[int, ...]  # UAVs that speak MAVLink
    served: dict[str, Any] | None = None

    @property
    def installation(self) -> Installation:
        return self.site.installation

    @contextmanager
    def at_work(self) -> Iterator[Playing]:
        """The people and the UAVs, until the end of the block."""
        site = self.installation
        with playing(self.folder, site.address, site.authority, site.address_for_uavs(), users=self.users) as playing_now:
            yield playing_now

    def one(self, statement: str, *values: Any) -> Any:
        return one_of(self.installation, statement, *values)

    def newest_record_at(self) -> datetime | None:
        """Of UAVs that speak MAVLink: when the newest was received."""
        found: datetime | None = self.one(
            "SELECT max(received_at) FROM telemetry_telemetryrecord WHERE uav_id = ANY(%s) AND received_at > now() - interval '10 minutes'",
            list(self.in_air),
        )
        return found

    def newest_estimate_at(self) -> datetime | None:
        found: datetime | None = self.one("SELECT max((estimated->>'at')::timestamptz) FROM telemetry_uavwatch WHERE estimated IS NOT NULL")
        return found

    def judge(self, course: Course, played: Playing) -> None:
        """Tell whether every promise of the clients' book was kept, and what Locust counted as failed for good."""
        command = [
            sys.executable,
            str(PROJECT_DIR / "deploy" / "load" / "invariants.py"),
            "--day",
            str(self.folder),
            "--settle-s",
            str(SETTLES_S),
        ]
        reported = subprocess.run(  # noqa: S603
            command, env=self.installation.environment(), cwd=PROJECT_DIR, stdout=subprocess.PIPE, text=True, check=False
        )
        lines = reported.stdout.splitlines()
        held = sum(line.startswith("|") and line.rstrip().endswith("| holds |") for line in lines)
        violated = [line.strip("| ") for line in lines if "VIOLATED" in line]
        counted = next((line for line in lines if "acknowledged items" in line), "nothing was counted")
        figure = f"{counted}; {held} invariants hold" + (f"; {violated[:4]}, {lines[-3:]}" if violated or reported.returncode else "")
        course.record(
            "the clients' ledger against the database",
            figure,
            "0 acknowledged items lost, 0 doubled",
            reported.returncode == 0 and held > 0,
        )
        whole = played.served().get(ALL)
        if whole is not None:
            figure = f"{whole.failures:,} of {whole.requests:,} requests failed for good"
            course.record(
                "the users of the day", figure + (f": {played.failures()[:3]}" if whole.failures else ""), "0", whole.failures == 0
            )


@contextmanager
def working_day(
    name: str, course: Course, counts: Mapping[str, int] | None = None, settings: Mapping[str, str] | None = None
) -> Iterator[Day]:
    """An installation with the ground, people and UAVs of the day."""
    if find_spec("locust") is None:
        raise CannotStart("Locust is not installed: the command for it is in deploy/load/README.md")
    size = SIZES[course.is_short]
    with shipped(name, counts, settings={**QUICK, **(settings or {})}) as installation:
        folder = installation.places.state / "day"
        folder.mkdir()
        command = [sys.executable, str(PROJECT_DIR / "deploy" / "load" / "prepare_day.py"), "--out", str(folder)]
        for what in ("people", "uavs", "companions"):
            command += [f"--{what}", str(size[what])]
        subprocess.run(command, env=installation.environment(), cwd=PROJECT_DIR, check=True)  # noqa: S603
        reported = json.loads((folder / "day.json").read_text())
        site = Site(installation, users_of(installation, reported["organisation"]))
        yield Day(site, folder, size["users"], tuple(uav["uav"] for uav in reported["in_air"]))
