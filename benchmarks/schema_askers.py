"""What 8 anonymous askers of the OpenAPI document change for somebody who is signed in.

    python -m benchmarks.schema_askers http://127.0.0.1:8000 --token spw_... [--askers 8] [--seconds 20] [--write]

Asks a running installation (./run; the token: manage.py api_token USER). One client lists missions one request after the other, alone and
then while the others ask for /api/schema without a pause. With --write the table goes to docs/performance.md.
"""

import argparse
import time
from concurrent.futures import ProcessPoolExecutor
from http.client import HTTPConnection
from statistics import quantiles
from urllib.parse import urlsplit

from benchmarks.report import machine, table, write_section

MAX_CHANGE_MS = 50.0


def seconds_of(host: str, path: str, headers: dict[str, str], lasts_s: float) -> list[float]:
    """How long each answer took. Raises SystemExit for any that is neither 200 nor, where an address asks for too much, 429."""
    connection, taken = HTTPConnection(host, timeout=120), []
    ends_s = time.monotonic() + lasts_s
    while time.monotonic() < ends_s:
        began_s = time.perf_counter()
        connection.request("GET", path, headers=headers)
        answer = connection.getresponse()
        answer.read()
        taken.append(time.perf_counter() - began_s)
        if answer.status not in (200, 429):
            raise SystemExit(f"{path} was answered {answer.status}")
    return taken


def with_askers(number: int, host: str, headers: dict[str, str], lasts_s: float) -> tuple[list[float], int]:
    """The times of whoever is signed in, and how many answers the others got meanwhile."""
    if not number:
        return seconds_of(host, "/api/v1/missions", headers, lasts_s), 0
    with ProcessPoolExecutor(number) as askers:  # processes of their own: their work is no part of what is measured
        got = [askers.submit(seconds_of, host, "/api/schema", {"Accept-Encoding": "gzip"}, lasts_s) for _ in range(number)]
        times = seconds_of(host, "/api/v1/missions", headers, lasts_s)
        return times, sum(len(one.result()) for one in got)


def row(name: str, times: list[float], answers: int) -> tuple[str, ...]:
    cuts = quantiles(times, n=100)
    return name, str(len(times)), f"{cuts[49] * 1e3:.1f}", f"{cuts[94] * 1e3:.1f}", f"{max(times) * 1e3:.1f}", str(answers)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("address")
    parser.add_argument("--token", required=True)
    parser.add_argument("--askers", type=int, default=8)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    host, headers = urlsplit(options.address).netloc, {"Authorization": f"Bearer {options.token}"}
    seconds_of(host, "/api/v1/missions", headers, 2.0)  # warms up
    seconds_of(host, "/api/schema", {}, 2.0)
    alone, _ = with_askers(0, host, headers, options.seconds)
    beside, answers = with_askers(options.askers, host, headers, options.seconds)
    change_ms = (quantiles(beside, n=100)[94] - quantiles(alone, n=100)[94]) * 1e3
    rows = [row("alone", alone, 0), row(f"beside {options.askers} askers of /api/schema", beside, answers)]
    text = table(["GET /api/v1/missions", "requests", "median [ms]", "p95 [ms]", "longest [ms]", "answers to the others meanwhile"], rows)
    reported = f"{text}\n\nThe p95 changes by {change_ms:+.1f} ms; less than {MAX_CHANGE_MS:g} is asked for. {machine('django')}"
    print(reported)
    if options.write:
        write_section("Askers of the OpenAPI document", reported + "\n\nAgain: `python -m benchmarks.schema_askers ADDRESS --token TOKEN`.")
    if change_ms >= MAX_CHANGE_MS:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
