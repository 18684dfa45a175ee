"""The working day as processes beside an installation: Locust with the people, and the fleet that speaks MAVLink.

    with playing(folder, installation.address, installation.authority, installation.address_for_uavs(), users=100) as day:
        ...                         # whatever is to happen meanwhile
    day.served()                    # what Locust counted, by name

`folder` has the day.json of prepare_day.py; what was acknowledged is added to its book. For chaos, scaler and soak alike.
"""

import csv
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
ENDS_WITHIN_S = 90.0
ALL = "Aggregated"


@dataclass(frozen=True)
class Served:
    """Of one name, or of all. Milliseconds are Locust's, rounded by it."""

    requests: int
    failures: int
    p50_ms: float
    p95_ms: float
    p99_ms: float
    per_s: float


@dataclass
class Playing:
    folder: Path
    results: Path
    locust: subprocess.Popen[bytes]
    fleet: subprocess.Popen[bytes]
    began_s: float = field(default_factory=time.time)

    @property
    def pids(self) -> dict[str, int]:
        return {"Locust": self.locust.pid, "fleet": self.fleet.pid}

    def end(self) -> None:
        """Both end by themselves after this: pages close, what is under way is answered, and the book is whole."""
        for process in (self.locust, self.fleet):
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
        for process in (self.locust, self.fleet):
            try:
                process.wait(ENDS_WITHIN_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def served(self) -> dict[str, Served]:
        """By name; ALL over everything. Only after the end."""
        found = {}
        with self.results.with_name(f"{self.results.name}_stats.csv").open() as text:
            for row in csv.DictReader(text):
                found[row["Name"]] = Served(
                    int(row["Request Count"]),
                    int(row["Failure Count"]),
                    *(_number(row[name]) for name in ("50%", "95%", "99%", "Requests/s")),
                )
        return found

    def failures(self) -> list[str]:
        """What failed for good, and how often, the most frequent first."""
        with self.results.with_name(f"{self.results.name}_failures.csv").open() as text:
            rows = sorted(csv.DictReader(text), key=lambda row: -int(row["Occurrences"]))
        return [f"{row['Occurrences']} x {row['Name']}: {row['Error']}" for row in rows]


def _number(text: str) -> float:
    return float(text) if text not in {"", "N/A"} else 0.0


@contextmanager
def playing(
    folder: Path,
    address: str,
    authority: Path | None,
    udp: tuple[str, int],
    *,
    users: int,
    spawn_rate: float = 5.0,
    name: str = "day",
    counts_ramp: bool = True,
) -> Iterator[Playing]:
    """Begins at once; ends both processes at the end of the block. Logs and figures lie in the folder.

    Without `counts_ramp` the figures begin when all users are there.
    """
    results = folder / name
    for old in folder.glob(f"{name}_*.csv"):
        old.unlink()
    environment = os.environ | {
        "SPANWISE_DAY": str(folder),
        "SPANWISE_DAY_AUTHORITY": str(authority or ""),
        "PYTHONPATH": str(ROOT),
    }
    locust = [sys.executable, "-m", "locust", "-f", str(ROOT / "deploy" / "load" / "working_day.py"), "--headless", "--host", address]
    locust += ["--users", str(users), "--spawn-rate", str(spawn_rate), "--csv", str(results), "--only-summary", "--loglevel", "WARNING"]
    locust += ["--stop-timeout", "60", *([] if counts_ramp else ["--reset-stats"])]
    fleet = [sys.executable, "-m", "deploy.load.day.fleet", "--day", str(folder), "--udp", f"{udp[0]}:{udp[1]}"]
    with (folder / f"{name}-locust.log").open("wb") as locust_log, (folder / f"{name}-fleet.log").open("wb") as fleet_log:
        day = Playing(
            folder,
            results,
            subprocess.Popen(locust, env=environment, cwd=folder, stdout=locust_log, stderr=locust_log),
            subprocess.Popen(fleet, env=environment, cwd=ROOT, stdout=fleet_log, stderr=fleet_log),
        )
        try:
            yield day
        finally:
            day.end()
