"""R5: web, live, gateway, estimator and workers are killed with -9, one after the other at random moments, while a team has its day.

What starts them again is the supervisor, as with ./run. A program has recovered when it does its work again: the web answers at its own
socket, a page of the live program shows a report that came in after the kill, the gateway has stored one, the estimator has estimated
at a later second, a worker says that it can take tasks.
"""

import time
from collections import defaultdict
from datetime import UTC, datetime

from deploy.load.scaling.replicas import kind_of
from tests.chaos.day import Day, working_day
from tests.chaos.experiment import Course, main, percentile
from tests.chaos.pages import Pages
from tests.chaos.probes import is_ready
from tests.chaos.site import wait_until

KILLED = (
    "web-1",
    "web-2",
    "live",
    "gateway",
    "estimator",
    "worker-data",
    "worker-flight",
    "worker-planning",
    "worker-simulation",
    "simulator",
    "beat",
)
KILLS, SHORT_KILLS = 50, 10
BETWEEN_S = 6.0
P95_S, MAX_S = 15.0, 30.0
GIVEN_UP_S = 120.0
PAGES = 3


def run(course: Course) -> None:
    with working_day("killed", course) as day:
        with Pages(day.site, PAGES) as pages, day.at_work() as played:
            begins_at = datetime.now(UTC)
            for name in KILLED:
                wait_until(lambda name=name: _works(day, pages, name, begins_at), f"{name} at work")  # type: ignore[misc]
            recovered_s = _kill_all(course, day, pages)
            time.sleep(5.0)
        _notify(course, recovered_s, pages)
        day.judge(course, played)


def _kill_all(course: Course, day: Day, pages: Pages) -> list[tuple[str, float]]:
    kills = SHORT_KILLS if course.is_short else KILLS
    order: list[str] = []
    while len(order) < kills:
        order += course.chance.sample(KILLED, len(KILLED))
    recovered_s = []
    for name in order[:kills]:
        time.sleep(BETWEEN_S * course.chance.uniform(0.2, 1.8))
        killed_at, began_s = datetime.now(UTC), time.monotonic()
        pid = day.installation.kill(name)
        day.installation.wait_for_another(name, pid)
        try:
            wait_until(lambda name=name, since=killed_at: _works(day, pages, name, since), name, GIVEN_UP_S)  # type: ignore[misc]
        except TimeoutError:
            print(f"{name} has not recovered in {GIVEN_UP_S:.0f} s", flush=True)
        recovered_s.append((name, time.monotonic() - began_s))
        print(f"{name}: {recovered_s[-1][1]:.1f} s", flush=True)
    return recovered_s


def _works(day: Day, pages: Pages, name: str, since: datetime) -> bool:
    """Whether it has done its work since then."""
    match kind_of(name):
        case "live":
            return pages.are_live_since(since)
        case "gateway":
            return (at := day.newest_record_at()) is not None and at > since
        case "estimator":
            return (at := day.newest_estimate_at()) is not None and at > since
    return is_ready(day.installation, name)


def _notify(course: Course, recovered_s: list[tuple[str, float]], pages: Pages) -> None:
    all_s = [taken_s for _, taken_s in recovered_s]
    of_kind = defaultdict(list)
    for name, taken_s in recovered_s:
        of_kind[kind_of(name)].append(taken_s)
    longest = ", ".join(f"{kind} {max(taken):.1f}" for kind, taken in sorted(of_kind.items()))
    figure = f"p50 {percentile(all_s, 0.5):.1f} s, p95 {percentile(all_s, 0.95):.1f} s, longest {max(all_s):.1f} s ({longest})"
    is_met = percentile(all_s, 0.95) <= P95_S and max(all_s) <= MAX_S
    course.record(f"{len(all_s)} kills (-9): until it works again", figure, f"p95 {P95_S:.0f} s, at most {MAX_S:.0f} s", is_met)
    course.record(f"{PAGES} open pages", f"{pages.gaps} gaps in the sequence", "0", pages.gaps == 0)


if __name__ == "__main__":
    main(run)
