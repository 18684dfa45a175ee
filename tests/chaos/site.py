"""The shipped programs over the demo region, with people and UAVs, for one experiment; nothing of it is left afterwards."""

import fcntl
import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from config.private_servers import state_directory
from deploy.load.installation import Installation
from scripts.places import PROJECT_DIR, CannotStart, Places
from scripts.supervision.supervision import Supervisor
from tests.chaos.asking import Client

DEMO = (
    ["make_demo_region", "{demo}"],
    ["import_osm", "{demo}/demo.osm.pbf", "--synthetic"],
    ["import_zones", "{demo}/demo-zones.json", "--synthetic"],
    ["import_terrain", "{demo}/demo-terrain.tif", "--synthetic"],
    ["load_demo"],
    ["build_graph"],
)
TIMEOUT_S = 300.0
ONLY_WEB = dict.fromkeys(
    ("worker-data", "worker-flight", "worker-planning", "worker-proofs", "worker-simulation", "gateway", "estimator", "simulator", "beat"),
    0,
)
KEEPS = "SPANWISE_CHAOS_KEEPS"  # set: logs and data stay for whoever looks for a reason


@dataclass
class Site:
    installation: Installation
    people: dict[str, Any]  # what tests.chaos.users has told

    def client(self, number: int = 0, *, keeps: bool = True) -> Client:
        """Of an operator; there are as many as `people` made."""
        tokens = self.people["operators"]
        return Client(self.installation.port, self.installation.trust(), tokens[number % len(tokens)], keeps=keeps)


@contextmanager
def shipped(
    name: str,
    counts: Mapping[str, int] | None = None,
    *,
    spare: Mapping[str, int] | None = None,
    settings: Mapping[str, str] | None = None,
    folder: Path | None = None,
) -> Iterator[Installation]:
    """The programs with an empty database, in a folder of their own (or in the one that is given)."""
    place = folder or state_directory() / "chaos" / name
    place.mkdir(parents=True, exist_ok=True)
    place.chmod(0o755)  # for PostgreSQL's user
    with place.with_suffix(".lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise CannotStart(f"this experiment is running already on {place}") from None
        try:
            Supervisor(Places(place), place).end_leftovers()  # of a run that was killed, before their folder goes
            _forget(place)
            with Installation(place, counts, spare=spare, settings=settings) as installation:
                yield installation
        finally:
            if KEEPS not in os.environ:
                _forget(place)


@contextmanager
def demo_site(
    name: str,
    counts: Mapping[str, int] | None = None,
    *,
    settings: Mapping[str, str] | None = None,
    folder: Path | None = None,
) -> Iterator[Site]:
    """With the demo region, operators and UAVs."""
    with shipped(name, counts, settings=settings, folder=folder) as installation:
        for command in DEMO:
            installation.manage(*[message.format(demo=installation.places.state / "demo") for message in command])
        yield Site(installation, users_of(installation))


def users_of(installation: Installation, organisation: int = 1) -> dict[str, Any]:
    """Operators with tokens, made beside those that may be there, and what they ask with."""
    command = [sys.executable, "-m", "tests.chaos.users", str(organisation)]
    reported = subprocess.run(  # noqa: S603
        command, env=installation.environment(), cwd=PROJECT_DIR, stdout=subprocess.PIPE, text=True, check=True
    ).stdout
    found: dict[str, Any] = json.loads(reported.splitlines()[-1])
    return found


def _forget(place: Path) -> None:
    for entry in place.iterdir() if place.exists() else ():
        shutil.rmtree(entry) if entry.is_dir() and not entry.is_symlink() else entry.unlink()


def wait_until(is_so: Callable[[], bool], what: str, patience_s: float = TIMEOUT_S) -> float:
    """Seconds until it is so."""
    began_s = time.monotonic()
    while not is_so():
        if time.monotonic() - began_s > patience_s:
            raise TimeoutError(f"{what}: not in {patience_s:.0f} s")
        time.sleep(0.05)
    return time.monotonic() - began_s
