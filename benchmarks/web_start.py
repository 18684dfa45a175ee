"""How long one web program takes from its start to serving, and to /readyz.

    python -m benchmarks.web_start [--times 5]

It is started as ./run and the image start it, on the database and the Redis of the environment (DATABASE_URL, REDIS_URL), which must be
migrated. Beside it stands what a fixed loop of Python takes, for machines that others use at the same time.
"""

import argparse
import http.client
import os
import signal
import socket
import subprocess
import tempfile
import time
from pathlib import Path
from statistics import median

from benchmarks.report import machine
from scripts import commands
from scripts.places import PROJECT_DIR

LOOPS = 20_000_000
NAMES = ("serving after", "ready after", "of a processor until it served", "until it was ready", "the loop: of a processor", "wall")
TIMEOUT_S = 120.0
TICKS_PER_S = os.sysconf("SC_CLK_TCK")


def loop() -> tuple[float, float]:
    """Processor seconds and wall seconds."""
    worked, began, total = time.process_time(), time.perf_counter(), 0
    for number in range(LOOPS):
        total += number
    return time.process_time() - worked, time.perf_counter() - began


def free_port() -> int:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return int(free.getsockname()[1])


def answers(port: int, path: str) -> int | None:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    try:
        connection.request("GET", path)
        return connection.getresponse().status
    except OSError:
        return None
    finally:
        connection.close()


def worked_s(session: int) -> float:
    """Processor time of all processes of a session."""
    ticks = 0
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[3]) == session:
            ticks += int(fields[11]) + int(fields[12])
    return ticks / TICKS_PER_S


def start() -> tuple[float, float, float, float]:
    """Seconds to the first answer and to /readyz, then processor seconds until each."""
    port, ready_port = free_port(), free_port()
    environment = os.environ | commands.MEMORY | {"SPANWISE_METRICS": f"127.0.0.1:{ready_port}", "PYTHONPATH": str(PROJECT_DIR)}
    with tempfile.TemporaryDirectory() as folder:
        began, serving_s, serving_work_s = time.perf_counter(), None, 0.0
        process = subprocess.Popen(
            commands.web("--host", "127.0.0.1", "--port", str(port)), cwd=folder, env=environment, start_new_session=True
        )
        try:
            while True:
                taken_s = time.perf_counter() - began
                if process.poll() is not None or taken_s > TIMEOUT_S:
                    raise SystemExit("the program did not come up")
                if serving_s is None and answers(port, "/sign-in") is not None:
                    serving_s, serving_work_s = time.perf_counter() - began, worked_s(process.pid)
                if serving_s is not None and answers(ready_port, "/readyz") == 200:
                    return serving_s, time.perf_counter() - began, serving_work_s, worked_s(process.pid)
                time.sleep(0.05)
        finally:
            os.killpg(process.pid, signal.SIGTERM)
            process.wait()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--times", type=int, default=5)
    times = parser.parse_args().times
    rows = []
    for _ in range(times):
        rows.append((*start(), *loop()))
        print("; ".join(f"{name} {value:.2f} s" for name, value in zip(NAMES, rows[-1], strict=True)), flush=True)
    print("medians: " + "; ".join(f"{name} {median(column):.2f} s" for name, column in zip(NAMES, zip(*rows, strict=True), strict=True)))
    print(machine())


if __name__ == "__main__":
    main()
