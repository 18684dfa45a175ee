"""R6: Redis is killed with -9 and comes back empty, again and again, while a team has its day and jobs are under way."""

import shutil
import time
from datetime import UTC, datetime

from tests.chaos.day import Day, working_day
from tests.chaos.experiment import Course, main
from tests.chaos.jobs import job_of, large_plan_body, states_at_the_end
from tests.chaos.pages import Pages
from tests.chaos.site import wait_until

TIMES, SHORT_TIMES = 10, 2
AWAY_S = 2.0
BETWEEN_S = 5.0
PAGES = 5
LIVE_WITHIN_S = 10.0
JOBS_EACH_TIME = 3
PEOPLE = 12  # who ask for them
JOBS_END_WITHIN_S = 120.0


def run(course: Course) -> None:
    with working_day("redis", course) as day:
        jobs: list[str] = []
        live_again_s: list[float] = []
        with Pages(day.site, PAGES) as pages, day.at_work() as played:
            pages.wait_until_live()
            for _ in range(SHORT_TIMES if course.is_short else TIMES):
                time.sleep(BETWEEN_S * course.chance.uniform(0.2, 1.8))
                jobs += [_large_plan(course, day) for _ in range(JOBS_EACH_TIME)]
                killed_at = datetime.now(UTC)
                _kill_and_empty(day)
                live_again_s.append(wait_until(lambda since=killed_at: pages.are_live_since(since), "live pages", 120.0))  # type: ignore[misc]
                print(f"live again after {live_again_s[-1]:.1f} s", flush=True)
                time.sleep(AWAY_S)
                day.installation.start("redis")
                jobs += [_large_plan(course, day) for _ in range(JOBS_EACH_TIME)]
            last_s = time.monotonic()
            ends = states_at_the_end(day.installation, jobs, JOBS_END_WITHIN_S)
            took_s = time.monotonic() - last_s
            pages.wait_until_live()
        course.record(
            f"{len(live_again_s)} times killed, emptied and {AWAY_S:.0f} s away: {PAGES} open pages show what was reported later",
            f"after {max(live_again_s):.1f} s at most, {pages.gaps} gaps, {sum(page.opened - 1 for page in pages.all)} opened again",
            f"{LIVE_WITHIN_S:.0f} s, 0 gaps", max(live_again_s) <= LIVE_WITHIN_S and pages.gaps == 0,
        )  # fmt: skip
        done = sum(state == "done" for state in ends)
        figure = f"{done} of {len(jobs)} done, the last {took_s:.0f} s after Redis was there"
        course.record("large plans asked for just before and just after", figure, "all, from PostgreSQL", done == len(jobs))
        day.judge(course, played)


def _kill_and_empty(day: Day) -> None:
    """Down before the supervisor could start it again with what it had written."""
    day.installation.kill("redis")
    day.installation.stop("redis")
    for entry in day.installation.places.redis.iterdir():
        shutil.rmtree(entry) if entry.is_dir() else entry.unlink()


def _large_plan(course: Course, day: Day) -> str:
    """Of somebody who has room for one more: nobody may have more than a few under way, and what was lost takes a while to be found."""
    body = large_plan_body(day.site, course.chance)
    for person in course.chance.sample(range(PEOPLE), PEOPLE):
        client = day.site.client(person)
        answer = client.ask("POST", "/api/v1/plans", body)
        client.close()
        if answer.status != 429:
            break
    assert answer.status == 202, (answer.status, answer.body[:300])
    return job_of(answer.json)


if __name__ == "__main__":
    main(run)
