"""The article's four load tests on the shipped configuration, TLS and sign-in included, on this machine alone.

    python deploy/load/run.py --scenario 1 2 3 4 --write          all of them, into docs/load-tests.md: about 65 minutes
    python deploy/load/run.py --scenario 1 --users 0.1 --seconds 0.2      a tenth of the users in a fifth of the time, to develop with

Starts everything in a folder of its own ($SPANWISE_VAR/load), with the ground of prepare_ground.py, and Locust beside it on the same
cores; each scenario with each number of web replicas. Ends with 1 where a bar was missed: no failure at all; at least 97 % of the demand
served in the hold of scenario 4's last stage; medians of scenarios 1 to 3 below 100 ms through every ramp and hold.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from config.private_servers import state_directory
from deploy.load.answers import Run
from deploy.load.ground import bring_ground
from deploy.load.installation import Installation
from deploy.load.report import RunReport, missed_bars, write_scenario
from deploy.load.scenarios import SCENARIOS, Scenario
from deploy.load.usage import machine_busy_s, usage
from scripts.places import PROJECT_DIR

SEVERAL = {1: (1, 2), 2: (1, 2), 3: (1, 2), 4: (2,)}  # web replicas, unless told
POLL_INTERVAL_S = 5.0
WARM_UPS = 40  # every thread of every replica has its connection, its graph and its compiled core
LOCUST_STOPS_S = 120.0


def locust_command(address: str) -> list[str]:
    command = [sys.executable, "-m", "locust", "-f", str(PROJECT_DIR / "deploy" / "load" / "plans.py"), "--headless", "--host", address]
    return [*command, "--only-summary", "--loglevel", "WARNING", "--stop-timeout", "60"]  # who goes waits for the answer


def warm_up(installation: Installation, ground: Path) -> None:
    """As many answers to both kinds of users as it takes until nothing is done for the first time."""
    body = json.dumps(json.loads((ground / "missions.json").read_text())[0]).encode()
    token = (ground / "tokens.txt").read_text().split()[0]
    headers = {"Authorization": f"Bearer {token}", "Content-Type": "application/json"}
    for _ in range(WARM_UPS):
        request = urllib.request.Request(f"{installation.address}/api/v1/plans", body, headers)  # noqa: S310 - our own address
        urllib.request.urlopen(request, timeout=600, context=installation.trust()).read()  # noqa: S310


def run_scenario(
    installation: Installation,
    ground: Path,
    scenario: Scenario,
    *,
    users: float,
    seconds: float,
    sessions: float,
    bodies: str = "missions.json",
    meanwhile: Callable[[float], None] = lambda at_s: None,
) -> RunReport:
    """Locust against the installation, and what everybody took of the machine. `meanwhile` is called every second with the run's time."""
    result = installation.places.state / "run.npz"
    result.unlink(missing_ok=True)
    reported = {
        "SPANWISE_LOAD_FOLDER": str(ground),
        "SPANWISE_LOAD_RESULT": str(result),
        "SPANWISE_LOAD_SCENARIO": str(scenario.number),
        "SPANWISE_LOAD_USERS": str(users),
        "SPANWISE_LOAD_SECONDS": str(seconds),
        "SPANWISE_LOAD_SESSIONS": str(sessions),
        "SPANWISE_LOAD_BODIES": bodies,
        "SPANWISE_LOAD_AUTHORITY": str(installation.authority),
    }
    scaled = scenario.scaled(users=users, seconds=seconds)
    looks: list[tuple[float, dict[str, float]]] = []
    log = installation.places.logs / "locust.log"
    with log.open("wb") as words:
        locust = subprocess.Popen(
            locust_command(installation.address), env=installation.environment() | reported, stdout=words, stderr=words, cwd=PROJECT_DIR
        )
        began_s, next_poll_s = time.time(), 0.0
        while locust.poll() is None:
            at_s = time.time() - began_s
            if at_s > scaled.lasts_s + LOCUST_STOPS_S:
                locust.kill()
                raise TimeoutError(f"Locust did not end; see {log}")
            if at_s >= next_poll_s:
                next_poll_s += POLL_INTERVAL_S
                looks.append((time.time(), _cpu_s(installation, locust.pid)))
            meanwhile(at_s)
            time.sleep(1.0)
    if not result.exists():
        raise RuntimeError(f"Locust left no result; see {log}")
    run = Run.read(result)
    stages = [run.stage(scaled, index) for index in range(len(scaled.stages))]
    resident_mb = {name: taken.resident_bytes / 1e6 for name, taken in installation.usage().items()}
    return RunReport(
        scenario=scenario.number,
        web_replicas=len(installation.names("web")),
        users_share=users,
        seconds_share=seconds,
        sessions=sessions,
        answers=len(run.at_s),
        failures=run.failures,
        faults=run.faults,
        stages=stages,
        cores=_cores_at_peak(scaled, run, looks),
        resident_mb={name: round(value) for name, value in resident_mb.items()},
        load_of_machine=os.getloadavg()[1],
        series=run.by_second(scaled.lasts_s, window_s=max(1.0, 5.0 * seconds)),
    )


def _cpu_s(installation: Installation, locust: int) -> dict[str, float]:
    taken: dict[str, float] = {}
    for name, used in installation.usage().items():
        kind = "web" if name.startswith("web-") else name if name in {"proxy", "postgresql", "redis"} else "the other programs"
        taken[kind] = taken.get(kind, 0.0) + used.cpu_s
    return taken | {"Locust": usage({"Locust": [locust]})["Locust"].cpu_s, "machine": machine_busy_s()}


def _cores_at_peak(scenario: Scenario, run: Run, looks: list[tuple[float, dict[str, float]]]) -> dict[str, float]:
    """Cores that each party took in the hold with the most users."""
    peak = max(range(len(scenario.stages)), key=lambda index: scenario.stages[index].users)
    begins_s = run.began_s + scenario.begins_s()[peak]
    inside = [look for look in looks if begins_s + scenario.ramp_s(peak) <= look[0] <= begins_s + scenario.stages[peak].lasts_s]
    if len(inside) < 2:
        return {}
    (first_s, first), (last_s, last) = inside[0], inside[-1]
    cores = {name: (last[name] - first.get(name, 0.0)) / (last_s - first_s) for name in last}
    cores["what else the machine did"] = cores["machine"] - sum(value for name, value in cores.items() if name != "machine")
    return {name: round(value, 2) for name, value in cores.items() if name != "machine"}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenario", type=int, nargs="+", choices=SCENARIOS, default=list(SCENARIOS))
    parser.add_argument("--replicas", type=int, nargs="+", help="numbers of web replicas; 1 and 2, for scenario 4 2")
    parser.add_argument("--users", type=float, default=1.0, help="share of the article's users, 1 is all of them")
    parser.add_argument("--seconds", type=float, default=1.0, help="share of the article's time")
    parser.add_argument("--sessions", type=float, default=0.05, help="share of users who sign in with a password")
    parser.add_argument("--json", type=Path, help="write the figures there, too")
    parser.add_argument("--write", action="store_true", help="put tables and pictures into docs/load-tests.md")
    options = parser.parse_args()

    _, most_files = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (most_files, most_files))
    if (options.users, options.seconds) != (1.0, 1.0):
        print(f"SCALED: {options.users:g} of the article's users, {options.seconds:g} of its time. These are no figures of its scenarios.")
    reports: list[RunReport] = []
    for number in options.scenario:
        of_this = []
        for web in options.replicas or SEVERAL[number]:
            with Installation(state_directory() / "load", {"web": web}) as installation:
                ground = bring_ground(installation)
                warm_up(installation, ground)
                report = run_scenario(
                    installation, ground, SCENARIOS[number], users=options.users, seconds=options.seconds, sessions=options.sessions
                )
            print(report.text(), flush=True)
            of_this.append(report)
        if options.write:
            write_scenario(SCENARIOS[number], of_this)
        reports += of_this
    if options.json:
        options.json.write_text(json.dumps([asdict(report) | {"series": None} for report in reports], indent=1))
    missed = [bar for report in reports for bar in missed_bars(report)]
    for bar in missed:
        print(f"MISSED {bar}")
    return int(bool(missed))


if __name__ == "__main__":
    sys.exit(main())
