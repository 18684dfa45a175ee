"""R8: of three web replicas one is killed with -9 and one is drained, again and again, while people ask for plans and pages."""

import time
from collections.abc import Callable

from tests.chaos.asking import Askers
from tests.chaos.experiment import Course, main, percentile
from tests.chaos.jobs import one_of
from tests.chaos.plans import SAVED_AS, Saver, planner, reader
from tests.chaos.probes import is_ready
from tests.chaos.site import ONLY_WEB, Site, demo_site, wait_until

REPLICAS = 3
PLANNERS, READERS, SAVERS = 8, 4, 2
KILLS, SHORT_KILLS = 10, 2
BETWEEN_S = 4.0


def run(course: Course) -> None:
    with demo_site("replicas", ONLY_WEB | {"web": REPLICAS}) as site:
        savers: list[Saver] = []

        def question(number: int) -> Callable[[], str]:
            client = site.client(number)
            if number < PLANNERS:
                return planner(site, client, course.seed + number)
            if number < PLANNERS + READERS:
                return reader(client)
            savers.append(Saver(site, client, course.seed + number))
            return savers[-1]

        wait_until(lambda: all(_serves(site, name) for name in site.installation.names("web")), "every web replica")
        for number in range(PLANNERS * REPLICAS):  # each has its graph and its compiled core
            question(number % PLANNERS)()
        killed = _broken(course, site, question, _kill)
        _notify(course, "killed with -9", killed)
        drained = _broken(course, site, question, _drain)
        _notify(course, "drained (TERM) and started again", drained)
        _report_saved(course, site, savers)


def _broken(
    course: Course, site: Site, question: Callable[[int], Callable[[], str]], harm: Callable[[Site, str], None]
) -> tuple[Askers, int]:
    times = SHORT_KILLS if course.is_short else KILLS
    with Askers(question, PLANNERS + READERS + SAVERS, pause_s=0.05) as askers:
        for _ in range(times):
            time.sleep(BETWEEN_S * course.chance.uniform(0.5, 1.5))
            name = course.chance.choice(site.installation.names("web"))
            harm(site, name)
            wait_until(lambda name=name: _serves(site, name), name)  # type: ignore[misc]
        time.sleep(2.0)
    return askers, times


def _kill(site: Site, name: str) -> None:
    pid = site.installation.kill(name)
    site.installation.wait_for_another(name, pid)


def _drain(site: Site, name: str) -> None:
    site.installation.restart(name)


def _serves(site: Site, name: str) -> bool:
    return is_ready(site.installation, name)


def _notify(course: Course, harm: str, ran: tuple[Askers, int]) -> None:
    askers, times = ran
    failed = {reported: number for reported, number in askers.counted.items() if reported != "200"}
    slowest_s = percentile([wait_s for _, wait_s in askers.waits_s], 0.99)
    figure = f"{sum(failed.values())} of {askers.counted.total():,} failed at {times} times, p99 {slowest_s * 1000:.0f} ms"
    course.record(
        f"one of {REPLICAS} web replicas is {harm}", figure + (f" {failed}, {askers.faults[:2]}" if failed else ""), "0 failed", not failed
    )


def _report_saved(course: Course, site: Site, savers: list[Saver]) -> None:
    saved = [one for saver in savers for one in saver.saved]
    lost = sum(one_of(site.installation, "SELECT 1 FROM missions_mission WHERE id = %s", one) is None for one in saved)
    rows = one_of(site.installation, "SELECT count(*) FROM missions_mission WHERE name = %s", SAVED_AS)
    figure = (
        f"{len(saved)} saved, {sum(saver.again for saver in savers)} asked again under their key: {lost} lost, {rows - len(saved)} doubled"
    )
    course.record("missions saved meanwhile", figure, "0 lost, 0 doubled", bool(saved) and not lost and rows == len(set(saved)))


if __name__ == "__main__":
    main(run)
