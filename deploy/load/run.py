"""Scenario 4 on the shipped configuration, on this machine alone: start the programs, load them, report.

    python deploy/load/run.py                          5,000 users, +50 a second, 10 s wait, 60 s of hold
    python deploy/load/run.py --users 10000 --hold-s 60

Wants the database and the files of prepare_ground.py (see deploy/load/README.md). It starts the web programs and `proxy` with the very
commands of ./run on a free port of the loopback, and Locust beside them, and ends all of them. Served demand counts the hold alone, when
every user is there: answers in it, of users x hold / (wait + mean answer).
"""

import argparse
import json
import os
import resource
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from benchmarks.report import machine, table, write_section
from config.private_servers import state_directory
from scripts.places import PROJECT_DIR, WEB_PROGRAMS, Places
from scripts.programs import Program, web_programs
from scripts.proxy import configuration

PATIENCE_S = 120.0
TICKS_PER_S = os.sysconf("SC_CLK_TCK")


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@contextmanager
def running(program: Program, environment: dict[str, str], log: Path) -> Iterator[int]:
    """The program with the command that the supervisor gives it; yields its process id."""
    program.folder.mkdir(parents=True, exist_ok=True)
    with log.open("wb") as words:
        process = subprocess.Popen(program.start_command(), cwd=PROJECT_DIR, env=environment, stdout=words, stderr=words)
        try:
            yield process.pid
        finally:
            process.send_signal(signal.SIGTERM)
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()


def cpu_s(names: dict[str, list[int]]) -> dict[str, float]:
    """Seconds of processor time so far of each group of processes, with those below them, also of those that have ended."""
    parents, spent = {}, {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                fields = (entry / "stat").read_text().rpartition(")")[2].split()
            except OSError:
                continue
            parents[int(entry.name)], spent[int(entry.name)] = int(fields[1]), sum(map(int, fields[11:15])) / TICKS_PER_S

    def is_below(process: int, roots: list[int]) -> bool:
        while process > 1:
            if process in roots:
                return True
            process = parents.get(process, 0)
        return False

    return {name: sum(value for process, value in spent.items() if is_below(process, roots)) for name, roots in names.items()}


def machine_busy_s() -> float:
    """Seconds that all cores together have not been idle."""
    ticks = [int(part) for part in Path("/proc/stat").read_text().splitlines()[0].split()[1:9]]
    return (sum(ticks) - ticks[3] - ticks[4]) / TICKS_PER_S


def servers_of(names: tuple[str, ...]) -> list[int]:
    """Process ids of servers that were there before."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                if (entry / "comm").read_text().strip() in names:
                    found.append(int(entry.name))
            except OSError:
                continue
    return found


def answers_in_hold(history: Path, begins_s: float, ends_s: float) -> tuple[float, int]:
    """Answers a second and failures between two instants, of Locust's once-a-second history."""
    rows = [line.split(",") for line in history.read_text().splitlines()]
    names = [name.strip('"') for name in rows[0]]
    at, who, total, failed = (names.index(name) for name in ("Timestamp", "Name", "Total Request Count", "Total Failure Count"))
    counted = [(float(row[at]), int(row[total]), int(row[failed])) for row in rows[1:] if row[who].strip('"') == "Aggregated"]
    inside = [row for row in counted if begins_s <= row[0] <= ends_s]
    first, last = inside[0], inside[-1]
    return (last[1] - first[1]) / (last[0] - first[0]), last[2] - first[2]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--users", type=int, default=5_000)
    parser.add_argument("--ramp", type=int, default=50, help="users more a second")
    parser.add_argument("--wait-s", type=float, default=10.0)
    parser.add_argument("--hold-s", type=int, default=60)
    parser.add_argument("--locusts", type=int, default=1, help="processes of Locust")
    parser.add_argument("--json", type=Path, help="write the figures there, too")
    parser.add_argument("--write", action="store_true", help="put them into docs/performance.md")
    options = parser.parse_args()

    places = Places(state_directory())
    folder = places.state / "load"
    ramp_s = -(-options.users // options.ramp)
    _, most_files = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (most_files, most_files))
    sockets = Path(tempfile.mkdtemp(prefix="sw-load-"))
    port, environment = free_port(), os.environ | {"SPANWISE_VAR": str(places.state), "PYTHONPATH": str(PROJECT_DIR)}
    places.generated.mkdir(parents=True, exist_ok=True)
    places.static.mkdir(parents=True, exist_ok=True)
    (places.generated / "nginx.conf").write_text(configuration(places, sockets, port))
    programs = {program.name: program for program in web_programs(places, sockets)}
    address = f"http://127.0.0.1:{port}"
    with ExitStack() as stack:
        web = [stack.enter_context(running(programs[name], environment, folder / f"{name}.log")) for name in WEB_PROGRAMS]
        proxy = stack.enter_context(running(programs["proxy"], environment, folder / "proxy.log"))
        end_s = time.monotonic() + PATIENCE_S
        while True:
            try:
                urllib.request.urlopen(f"{address}/healthz", timeout=5).close()  # noqa: S310 - our own address
                break
            except OSError:
                if time.monotonic() > end_s:
                    print(f"the programs do not answer; see {folder}/web-1.log", file=sys.stderr)
                    return 1
                time.sleep(0.2)
        for _ in range(40):  # every thread of every worker has its connection, its graph and its compiled core
            warm_up(address, folder)
        results = folder / "locust"
        for old in folder.glob("locust*"):
            old.unlink()
        command = [sys.executable, "-m", "locust", "-f", str(PROJECT_DIR / "deploy" / "load" / "plans.py"), "--headless", "--host", address]
        command += ["--users", str(options.users), "--spawn-rate", str(options.ramp), "--run-time", f"{ramp_s + options.hold_s + 10}s"]
        command += ["--csv", str(results), "--csv-full-history", "--only-summary", "--loglevel", "WARNING", "--stop-timeout", "0"]
        if options.locusts > 1:
            command += ["--processes", str(options.locusts)]
        load = {
            "SPANWISE_LOAD_FOLDER": str(folder),
            "SPANWISE_LOAD_WAIT_S": str(options.wait_s),
            "SPANWISE_LOAD_LOCUSTS": str(options.locusts),
        }
        began_s = time.time()
        with (folder / "locust.log").open("wb") as words:
            locust = subprocess.Popen(command, env=environment | load, stdout=words, stderr=words, cwd=folder)
        groups = {
            "web": web,
            "proxy": [proxy],
            "PostgreSQL": servers_of(("postgres",)),
            "Redis": servers_of(("redis-server",)),
            "Locust": [locust.pid],
        }
        hold_begins_s = began_s + ramp_s + 5  # Locust needs some seconds before its first user
        time.sleep(max(0.0, hold_begins_s - time.time()))
        before, busy_before_s, at_s = cpu_s(groups), machine_busy_s(), time.time()
        time.sleep(options.hold_s)
        after, busy_after_s, ended_s = cpu_s(groups), machine_busy_s(), time.time()
        try:
            locust.wait(60)
        except subprocess.TimeoutExpired:
            locust.kill()
    spent = {name: (after[name] - before[name]) / (ended_s - at_s) for name in groups}
    return report(options, folder, spent, (busy_after_s - busy_before_s) / (ended_s - at_s), (at_s, ended_s))


def warm_up(address: str, folder: Path) -> None:
    body = json.dumps(json.loads((folder / "missions.json").read_text())[0]).encode()
    token = (folder / "tokens.txt").read_text().split()[0]
    headers = {"Authorization": f"Bearer {token}", "Content-Type": "application/json"}
    urllib.request.urlopen(urllib.request.Request(f"{address}/api/v1/plans", body, headers), timeout=PATIENCE_S).read()  # noqa: S310


def report(options: argparse.Namespace, folder: Path, cores: dict[str, float], busy: float, hold: tuple[float, float]) -> int:
    """Print the figures; 1 if the demand was not served."""
    rows = (folder / "locust_stats.csv").read_text().splitlines()
    whole = dict(zip(rows[0].split(","), rows[-1].split(","), strict=True))
    answers_per_s, failed = answers_in_hold(folder / "locust_stats_history.csv", *hold)
    mean_s = float(whole["Average Response Time"]) / 1_000
    demand_per_s = options.users / (options.wait_s + mean_s)
    figures = {
        "users": options.users,
        "hold_s": round(hold[1] - hold[0], 1),
        "answers_per_s": round(answers_per_s, 1),
        "demand_per_s": round(demand_per_s, 1),
        "demand_served_percent": round(100 * answers_per_s / demand_per_s, 1),
        "requests": int(whole["Request Count"]),
        "failures": int(whole["Failure Count"]),
        "failures_in_hold": failed,
        "p50_ms": float(whole["50%"]),
        "p95_ms": float(whole["95%"]),
        "p99_ms": float(whole["99%"]),
        "longest_ms": round(float(whole["Max Response Time"])),
        "answer_bytes": round(float(whole["Average Content Size"])),
        "cores": {name: round(value, 2) for name, value in cores.items()},
        "cpu_ms_per_answer": {name: round(1_000 * value / max(answers_per_s, 0.1), 2) for name, value in cores.items()},
        "cores_of_others": round(busy - sum(cores.values()), 2),
    }
    for name, value in figures.items():
        print(f"{name:22} {value}")
    if options.json:
        options.json.write_text(json.dumps(figures, indent=1))
    if options.write:
        write_section(f"The load test: {options.users:,} users", section(options, figures, cores))
    return 0 if figures["demand_served_percent"] >= 97 and not figures["failures"] else 1


def section(options: argparse.Namespace, figures: dict[str, Any], cores: dict[str, float]) -> str:
    rows = [
        ["answers a second in the hold, of the demand", f"{figures['answers_per_s']} of {figures['demand_per_s']}"],
        ["demand served", f"{figures['demand_served_percent']} %"],
        ["failures of requests, over the whole run", f"{figures['failures']} of {figures['requests']:,}"],
        ["p50, p95, p99 over the whole run", ", ".join(f"{figures[name]:,.0f} ms" for name in ("p50_ms", "p95_ms", "p99_ms"))],
        *([f"{name}: cores, CPU an answer", f"{value:.2f}, {figures['cpu_ms_per_answer'][name]} ms"] for name, value in cores.items()),
        ["what else the machine did: cores", f"{figures['cores_of_others']}"],
    ]
    command = f"`python deploy/load/run.py --users {options.users} --hold-s {options.hold_s} --locusts {options.locusts} --write`"
    return f"""{command}

{options.users:,} users, {options.ramp} more a second, {options.wait_s:g} s wait, each with a token; 2 UAVs and 4 targets on the
graph of deploy/load/README.md, whole plans of {figures["answer_bytes"] / 1_000:.0f} kB; Locust on the same cores.
{machine("granian", "django", "psycopg", "numba", "locust")}

{table(["", ""], rows)}"""


if __name__ == "__main__":
    sys.exit(main())
