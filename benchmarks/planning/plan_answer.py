"""What one `POST /api/v1/plans` costs a web program: processor time through the whole WSGI application, in process.

    .venv/bin/python -m benchmarks.planning.plan_answer
    .venv/bin/python -m benchmarks.planning.plan_answer --beside ../before --rounds 40      in turns with another checkout of this
    repository

Plans 3 targets with 2 UAVs on the ground of the load tests (deploy/load/prepare_ground.py), which is made in $SPANWISE_VAR/load if it is
not there. Programs with a token and people with a session and its CSRF token ask; each round asks every checkout for the same missions.
The least of the rounds counts: whatever else the machine does only adds to it.
"""

import argparse
import io
import json
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import cycle
from pathlib import Path
from typing import Any

from benchmarks.report import machine, table
from config.private_servers import state_directory
from deploy.load.ground import bring_ground
from deploy.load.installation import Installation
from scripts.places import PROJECT_DIR

TARGETS = 3
MISSIONS = 20  # asked for in every round, so that rounds are alike
KINDS = ("token", "session")
WARM_UPS = 200
ADDRESS = "/api/v1/plans"
CSRF_TOKEN = "k" * 32


def environ(body: bytes, headers: dict[str, str]) -> dict[str, Any]:
    """A request as granian hands it over from the proxy."""
    return {
        "REQUEST_METHOD": "POST",
        "SCRIPT_NAME": "",
        "PATH_INFO": ADDRESS,
        "QUERY_STRING": "",
        "SERVER_NAME": "localhost",
        "SERVER_PORT": "443",
        "SERVER_PROTOCOL": "HTTP/1.1",
        "REMOTE_ADDR": "127.0.0.1",
        "CONTENT_TYPE": "application/json",
        "CONTENT_LENGTH": str(len(body)),
        "HTTP_HOST": "localhost",
        "HTTP_ACCEPT": "*/*",
        "HTTP_X_FORWARDED_PROTO": "https",
        "wsgi.version": (1, 0),
        "wsgi.url_scheme": "https",
        "wsgi.input": io.BytesIO(body),
        "wsgi.errors": sys.stderr,
        "wsgi.multithread": True,
        "wsgi.multiprocess": False,
        "wsgi.run_once": False,
    } | headers


def serve(ground: Path, threads: int) -> None:
    """Answer "token 20" on standard input with the milliseconds of processor time of each of 20 answers."""
    from config.wsgi import application  # noqa: PLC0415 - of the checkout that is measured, in its process alone

    bodies = cycle([json.dumps(body | {"targets": body["targets"][:TARGETS]}).encode() for body in _missions(ground)[:MISSIONS]])
    senders = {"token": _programs(ground), "session": _people()}
    ask = _asker(application)
    with ThreadPoolExecutor(threads) as pool:
        for line in sys.stdin:
            kind, count = line.split()
            requests = [environ(next(bodies), next(senders[kind])) for _ in range(int(count))]
            began_s = time.process_time()
            list(pool.map(ask, requests))
            print(1_000 * (time.process_time() - began_s) / len(requests), flush=True)


def _missions(ground: Path) -> list[dict[str, Any]]:
    missions: list[dict[str, Any]] = json.loads((ground / "missions.json").read_text())
    return missions


def _programs(ground: Path) -> Iterator[dict[str, str]]:
    """One user after another, as in the load tests: nobody asks twice in a second."""
    return cycle([{"HTTP_AUTHORIZATION": f"Bearer {token}"} for token in (ground / "tokens.txt").read_text().split()])


def _people() -> Iterator[dict[str, str]]:
    """Some users who have signed in."""
    from django.conf import settings  # noqa: PLC0415 - Django is set up
    from django.test import Client  # noqa: PLC0415

    from workspace.models import User  # noqa: PLC0415

    people = []
    for user in User.objects.filter(username__startswith="load-")[:200]:
        client = Client()
        client.force_login(user)
        session = client.cookies[settings.SESSION_COOKIE_NAME].value
        cookies = f"{settings.SESSION_COOKIE_NAME}={session}; {settings.CSRF_COOKIE_NAME}={CSRF_TOKEN}"
        people.append({"HTTP_COOKIE": cookies, "HTTP_X_CSRFTOKEN": CSRF_TOKEN, "HTTP_REFERER": "https://localhost/map"})
    return cycle(people)


def _asker(application: Callable[..., Any]) -> Callable[[dict[str, Any]], None]:
    def ask(request: dict[str, Any]) -> None:
        stated = []
        answer = application(request, lambda status, headers: stated.append(status))
        content = b"".join(answer)
        answer.close()
        if stated != ["200 OK"]:
            raise RuntimeError(f"{stated}: {content[:500]!r}")

    return ask


class Measured:
    """The WSGI application of one checkout, in a process of its own."""

    def __init__(self, checkout: Path, environment: dict[str, str], ground: Path, threads: int) -> None:
        self.ms: dict[str, list[float]] = {kind: [] for kind in KINDS}
        self._process = subprocess.Popen(
            [sys.executable, "-m", "benchmarks.planning.plan_answer", "--serve", str(ground), "--threads", str(threads)],
            env=environment | {"PYTHONPATH": str(checkout)},
            cwd=checkout,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def measure(self, kind: str, count: int) -> float:
        assert self._process.stdin is not None and self._process.stdout is not None  # noqa: S101 - both are pipes
        print(kind, count, file=self._process.stdin, flush=True)
        return float(self._process.stdout.readline())

    def close(self) -> None:
        self._process.terminate()
        self._process.wait()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--beside", type=Path, help="another checkout, with this file in it")
    parser.add_argument("--rounds", type=int, default=200)
    parser.add_argument("--threads", type=int, default=1, help="that answer at once; a web program has 4")
    parser.add_argument("--serve", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.serve:
        serve(options.serve, options.threads)
        return
    checkouts = [PROJECT_DIR] if options.beside is None else [options.beside.resolve(), PROJECT_DIR]
    alone = dict.fromkeys(("live", "uav-link", "gateway", "estimator", "simulator", "beat"), 0)
    workers = {f"worker-{queue}": 0 for queue in ("data", "flight", "planning", "simulation")}
    with Installation(state_directory() / "load", {"web": 1} | alone | workers) as installation:
        ground = bring_ground(installation)
        installation.stop("web-1")
        measured = [Measured(checkout, installation.environment(), ground, options.threads) for checkout in checkouts]
        try:
            for number in range(options.rounds + 1):
                for kind in KINDS:
                    for each in measured if number % 2 else measured[::-1]:
                        ms = each.measure(kind, MISSIONS if number else WARM_UPS)
                        each.ms[kind] += [ms] if number else []
        finally:
            for each in measured:
                each.close()
    rows = [
        [str(checkout), kind, f"{min(each.ms[kind]):.3f} ms", f"{statistics.median(each.ms[kind]):.3f} ms"]
        for kind in KINDS
        for checkout, each in zip(checkouts, measured, strict=True)
    ]
    print(table(["checkout", "who asks", "least", "middle"], rows), machine(), sep="\n\n")
    if options.beside is not None:
        for kind in KINDS:
            before, here = (min(each.ms[kind]) for each in measured)
            paired = statistics.median(b / a for a, b in zip(*(each.ms[kind] for each in measured), strict=True))
            print(
                f"{kind}: {100 * (here / before - 1):+.1f} % of processor time an answer; middle of the rounds {100 * (paired - 1):+.1f} %"
            )


if __name__ == "__main__":
    main()
