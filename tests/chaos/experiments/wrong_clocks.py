"""R11: a worker, a web program, a gateway and an estimator whose clocks are wrong, beside others whose clocks are right.

`faketime` (Debian's) shifts the clock of one program. Clocks of servers are to be within 5 s (F3548): there nothing changes. What is wrong
by an hour or by years must neither do work twice nor take work away from others.
"""

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime, timedelta

from deploy.load.scaling.replicas import replicas
from scripts.installation.system_packages import find_program
from scripts.places import PROJECT_DIR
from scripts.supervision.processes import end_processes
from tests.chaos.day import Day, working_day
from tests.chaos.experiment import Course, main
from tests.chaos.jobs import job_of, large_plan_body, states_at_the_end
from tests.chaos.probes import answer_of
from tests.chaos.site import Site, wait_until

SKEWS = ("-1h", "+1h", "+10y")
SMALL = ("+5s", "-5s")
JOBS = 3
JOBS_END_WITHIN_S = 300.0
LOOKED_S = 10.0
COUNTS = {"worker-planning": 0, "worker-flight": 0, "worker-data": 0, "worker-simulation": 0, "simulator": 0, "gateway": 0, "estimator": 0}


def run(course: Course) -> None:
    if find_program("faketime") is None:
        course.leave_out("clocks that are wrong", "Debian's faketime is not installed", "no work twice, none taken away")
        return
    with working_day("clocks", course, COUNTS) as day:
        for skew in SKEWS[:1] if course.is_short else SKEWS:
            _worker(course, day.site, skew)
        for skew in SKEWS[1:2] if course.is_short else SKEWS:
            _web(course, day.site, skew)
        for skew in SMALL[:1] if course.is_short else SMALL:
            _watched(course, day, skew)


@contextmanager
def skewed(site: Site, name: str, kind: str, number: int, skew: str) -> Iterator[dict[str, str]]:
    """A replica of its own, that no supervisor knows; yields its environment."""
    installation = site.installation
    program = next(one for one in replicas(installation.places, installation.sockets, {kind: number}) if one.name == name)
    program.folder.mkdir(parents=True, exist_ok=True)
    environment = installation.environment() | program.environment
    with installation.log(f"{name}{skew}").open("ab") as log:
        command = [find_program("faketime") or "faketime", "-f", skew, *program.command]
        process = subprocess.Popen(command, cwd=program.folder, env=environment, stdout=log, stderr=log, start_new_session=True)  # noqa: S603
        try:
            yield environment
        finally:
            end_processes([program.folder], patience_s=20.0)
            process.wait(30)


def _worker(course: Course, site: Site, skew: str) -> None:
    with skewed(site, "worker-planning", "worker-planning", 1, skew):
        client, jobs = site.client(), []
        for _ in range(JOBS):
            answer = client.ask("POST", "/api/v1/plans", large_plan_body(site, course.chance))
            jobs.append(job_of(answer.json))
        done = states_at_the_end(site.installation, jobs, JOBS_END_WITHIN_S).count("done")
    from_rows = _rows(site, jobs)
    figure = f"{done} of {len(jobs)} done, in {sum(from_rows)} attempts"
    course.record(f"a planner's worker at {skew}", figure, "each once", done == len(jobs) == sum(from_rows))


def _rows(site: Site, jobs: list[str]) -> list[int]:
    reported = site.installation.manage(
        "shell", "--verbosity", "0", "-c",
        f"from workspace.models import Job; print(list(Job.objects.filter(pk__in={jobs!r}).values_list('attempts', flat=True)))",
    )  # fmt: skip
    found: list[int] = json.loads(reported.strip().splitlines()[-1])
    return found


def _web(course: Course, site: Site, skew: str) -> None:
    """Tokens of a day: an hour makes no difference, ten years do. Nothing it writes may keep others from working."""
    own = site.installation.sockets / "web-3.sock"
    own.unlink(missing_ok=True)
    with skewed(site, "web-3", "web", 3, skew):
        wait_until(lambda: answer_of(own, "/healthz")[0] == 200, "the web program", 240.0)
        token = site.people["operators"][0]
        status = answer_of(own, "/api/v1/missions?limit=1", Authorization=f"Bearer {token}")[0]
        beside = site.client().ask("GET", "/api/v1/missions?limit=1").status
    expected = 401 if skew.endswith("y") else 200
    figure = f"a token of a day: {status}; the program beside it: {beside}"
    course.record(
        f"a web program at {skew}", figure, f"by its own clock ({expected}); the other goes on", (status, beside) == (expected, 200)
    )


def _watched(course: Course, day: Day, skew: str) -> None:
    with skewed(day.site, "gateway", "gateway", 1, skew) as environment, skewed(day.site, "estimator", "estimator", 1, skew):
        fleet = subprocess.Popen(  # noqa: S603
            [sys.executable, "-m", "deploy.load.day.fleet", "--day", str(day.folder), "--udp", environment["SPANWISE_GATEWAY_UDP"]],
            cwd=PROJECT_DIR, env=os.environ | {"PYTHONPATH": str(PROJECT_DIR)},
        )  # fmt: skip
        try:
            begins_at = datetime.now(UTC)
            after = begins_at + timedelta(seconds=LOOKED_S)
            wait_until(lambda: (at := day.newest_record_at()) is not None and at > after, "reports")
            wait_until(lambda: (at := day.newest_estimate_at()) is not None and at > after, "estimates")
            time.sleep(LOOKED_S)
            stored = day.one("SELECT count(*) FROM telemetry_telemetryrecord WHERE received_at > %s", after)
            flagged = day.one("SELECT count(*) FROM telemetry_alert WHERE code LIKE 'link-%%' AND opened_at > %s", after)
        finally:
            fleet.terminate()
            fleet.wait(30)
    figure = f"{stored:,} reports stored, UAVs estimated, {flagged} told as late or lost"
    course.record(f"a gateway and an estimator at {skew}", figure, "as if they were right", bool(stored) and not flagged)


if __name__ == "__main__":
    main(run)
