"""S7: one user floods plans, another lists; what others wait for changes little, and the flood is refused before any work."""

import time
from collections import Counter
from collections.abc import Callable

from tests.chaos.asking import Askers
from tests.chaos.experiment import Course, main, percentile
from tests.chaos.plans import planner, reader
from tests.chaos.site import ONLY_WEB, Site, demo_site

OTHERS = 4
EACH_S, SHORT_EACH_S = 60.0, 15.0
ROUNDS = 2  # without, with, without, with: what the machine does beside it falls on both
FLOODERS = 4
FLOODER = 11  # of the operators
MAX_CHANGE = 0.2
INDISTINGUISHABLE_S = 0.005  # of a p95 of some milliseconds


def run(course: Course) -> None:
    with demo_site("flood", ONLY_WEB) as site:
        for number in range(8):
            planner(site, site.client(number), number)()
        calm_s, flooded_s = [], []
        reported: Counter[str] = Counter()
        for _ in range(ROUNDS):
            calm_s += _others(course, site)
            with Askers(lambda number: planner(site, site.client(FLOODER), number), FLOODERS) as flood:
                flooded_s += _others(course, site)
            reported += flood.counted
        refused, odd = reported["429"], {what: number for what, number in reported.items() if what not in {"200", "429"}}
    course.record(
        "the flood of one user",
        f"{refused:,} of {reported.total():,} plans refused with 429 {odd or ''}",
        "429 above 40 a second",
        refused > 0 and not odd,
    )
    before_s, after_s = percentile(calm_s, 0.95), percentile(flooded_s, 0.95)
    figure = f"p95 {before_s * 1000:.0f} ms without, {after_s * 1000:.0f} ms with: {after_s / before_s - 1:+.0%}"
    is_met = after_s <= before_s * (1 + MAX_CHANGE) or after_s - before_s <= INDISTINGUISHABLE_S
    course.record(
        "what others wait for a plan or a list",
        figure,
        f"changes by less than {MAX_CHANGE:.0%} or {INDISTINGUISHABLE_S * 1000:.0f} ms",
        is_met,
    )


def _others(course: Course, site: Site) -> list[float]:
    def question(number: int) -> Callable[[], str]:
        client = site.client(number)
        return planner(site, client, course.seed + number) if number % 2 else reader(client)

    with Askers(question, OTHERS, pause_s=0.25) as others:
        time.sleep(SHORT_EACH_S if course.is_short else EACH_S)
    assert set(others.counted) <= {"200"}, others.counted
    return [wait_s for _, wait_s in others.waits_s]


if __name__ == "__main__":
    main(run)
