"""R7: PostgreSQL is killed with all its processes and is away for 30 s, while a team has its day.

Every question to pages and the API is counted by its status and whether it says when to ask again. Once PostgreSQL takes connections
again, each program is asked whether it works, and none may have been started again by anybody but itself: process ids stay.
"""

import signal
import time
from collections.abc import Callable
from datetime import UTC, datetime
from typing import Any
from uuid import uuid4

from scripts.supervision.processes import end_processes
from tests.chaos.asking import Askers, Client
from tests.chaos.day import Day, working_day
from tests.chaos.experiment import Course, main
from tests.chaos.experiments.killed_programs import KILLED
from tests.chaos.pages import Pages
from tests.chaos.plans import plan_body
from tests.chaos.probes import is_ready
from tests.chaos.site import wait_until

AWAY_S, TIMES, SHORT_TIMES = 30.0, 2, 1
BEFORE_S = 10.0
READY_WITHIN_S = 5.0
GIVEN_UP_S = 90.0
PAGES = 3
READ = ("/api/v1/missions?limit=5", "/api/v1/uavs", "/api/v1/live", "/api/v1/alerts", "/api/v1/jobs", "/sign-in", "/api/v1/ground")


def run(course: Course) -> None:
    with working_day("database", course) as day:
        written: list[str] = []
        ready_s: dict[str, float] = {}
        with Pages(day.site, PAGES) as pages, day.at_work() as played:
            wait_until(lambda: all(is_ready(day.installation, name) for name in KILLED), "every program")
            pages.wait_until_live()
            pids = {name: day.installation.pid(name) for name in KILLED}
            with Askers(lambda number: _question(course, day, number, written), 6, pause_s=0.1) as askers:
                time.sleep(BEFORE_S)
                for _ in range(SHORT_TIMES if course.is_short else TIMES):
                    _kill(day)
                    time.sleep(AWAY_S)
                    day.installation.start("postgresql")
                    for name, taken_s in _until_all_work(day, pages).items():
                        ready_s[name] = max(taken_s, ready_s.get(name, 0.0))
                    time.sleep(BEFORE_S)
            again = {name: pid for name, pid in pids.items() if day.installation.pid(name) != pid}
        _notify(course, day, askers, written, ready_s)
        course.record("programs that had to be started again", ", ".join(again) or "none", "none", not again)
        day.judge(course, played)


def _question(course: Course, day: Day, number: int, written: list[str]) -> Callable[[], str]:
    client, chance = day.site.client(number), course.chance.__class__(course.seed + number)

    def ask() -> str:
        match number % 3:
            case 0:
                answer = client.ask("GET", chance.choice(READ))
            case 1:
                answer = client.ask("POST", "/api/v1/plans", plan_body(day.site, chance))
            case _:
                answer = _write(client, plan_body(day.site, chance), written)
        if answer.status == 503:
            return "503 with Retry-After" if int(answer.headers.get("retry-after", "0")) > 0 else "503 without Retry-After"
        return str(answer.status)

    return ask


def _write(client: Client, body: dict[str, Any], written: list[str]) -> Any:
    answer = client.ask("POST", "/api/v1/missions", {**body, "name": "Chaos"}, **{"Idempotency-Key": str(uuid4())})
    if answer.status in (201, 202):
        written.append(str(answer.json["id"] if "id" in answer.json else answer.json["mission"]["id"]))
    return answer


def _kill(day: Day) -> None:
    """All its processes at once; stopped before the supervisor could start it again."""
    end_processes([day.installation.places.data], first_signal=signal.SIGKILL)
    day.installation.stop("postgresql")


def _until_all_work(day: Day, pages: Pages) -> dict[str, float]:
    """Seconds after it takes connections again, by program; live, gateway and estimator by what they have done since."""
    wait_until(lambda: day.one("SELECT 1") == 1, "PostgreSQL")
    began_s, back_at = time.monotonic(), datetime.now(UTC)
    checks: dict[str, Callable[[], bool]] = {
        name: (lambda name=name: is_ready(day.installation, name))  # type: ignore[misc]
        for name in KILLED if name not in {"live", "gateway", "estimator"}
    } | {
        "live": lambda: pages.are_live_since(back_at),
        "gateway": lambda: (at := day.newest_record_at()) is not None and at > back_at,
        "estimator": lambda: (at := day.newest_estimate_at()) is not None and at > back_at,
        "pages and API": lambda: day.site.client(11, keeps=False).ask("GET", "/api/v1/missions?limit=1").status == 200,
    }  # fmt: skip
    ready_s: dict[str, float] = {}
    while checks and time.monotonic() - began_s < GIVEN_UP_S:
        for name in list(checks):
            if checks[name]():
                ready_s[name] = time.monotonic() - began_s
                del checks[name]
        time.sleep(0.1)
    return ready_s | dict.fromkeys(checks, GIVEN_UP_S)


def _notify(course: Course, day: Day, askers: Askers, written: list[str], ready_s: dict[str, float]) -> None:
    away = askers.counted["503 with Retry-After"]
    odd = {reported: number for reported, number in askers.counted.items() if reported not in {"200", "201", "202", "503 with Retry-After"}}
    figure = f"{away:,} of {askers.counted.total():,} answered 503 with Retry-After" + (
        f"; {odd} {askers.faults[:2]}" if odd else ", nothing else"
    )
    course.record(
        f"PostgreSQL killed (-9) and {AWAY_S:.0f} s away: requests", figure, "503 with Retry-After, never 500", away > 0 and not odd
    )
    lost = [one for one in written if day.one("SELECT 1 FROM missions_mission WHERE id = %s", one) is None]
    course.record("missions whose saving was acknowledged", f"{len(lost)} of {len(written)} lost", "0 lost", not lost and bool(written))
    slowest = sorted(ready_s.items(), key=lambda item: -item[1])
    reported = ", ".join(f"{name} {taken_s:.1f}" for name, taken_s in slowest[:5])
    is_met = slowest[0][1] <= READY_WITHIN_S
    course.record(
        f"at work again, {len(ready_s)} programs", f"{slowest[0][1]:.1f} s ({reported})", f"{READY_WITHIN_S:.0f} s, by itself", is_met
    )


if __name__ == "__main__":
    main(run)
