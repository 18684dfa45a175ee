"""R14: the file system with PostgreSQL, Redis, logs and uploads is filled to the last byte while people work, and room is made again.

The file system is a small one in memory, which only root can mount.
"""

import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.client import HTTPException
from pathlib import Path
from uuid import uuid4

from config.private_servers import state_directory
from scripts.installation.system_packages import find_program
from tests.chaos.asking import Askers
from tests.chaos.experiment import Course, main
from tests.chaos.jobs import job_of, large_plan_body, one_of, states_at_the_end
from tests.chaos.plans import plan_body, reader
from tests.chaos.site import KEEPS, Site, demo_site, wait_until

SIZE_MIB = 900
FULL_S, SHORT_FULL_S = 40.0, 15.0
BEFORE_S = 5.0
JOBS_END_WITHIN_S = 180.0
COUNTS = {"gateway": 0, "estimator": 0, "simulator": 0, "worker-simulation": 0}
WRITTEN, HALF = "missions whose saving was acknowledged", "missions without their targets"


def run(course: Course) -> None:
    if os.geteuid() != 0:
        course.leave_out("a full disk", "only root can mount a small file system", "refusals are told, nothing is half written")
        return
    with small_disk() as disk, demo_site("disk", COUNTS, settings={"SPANWISE_LARGE_PLAN_SEARCH_S": "1"}, folder=disk / "state") as site:
        written: list[str] = []
        jobs: list[str] = []
        with Askers(lambda number: _question(course, site, number, written, jobs), 4, pause_s=0.2) as askers:
            time.sleep(BEFORE_S)
            before = len(written)
            ballast = disk / "ballast"
            _fill(ballast, SHORT_FULL_S if course.is_short else FULL_S)
            ballast.unlink()
            refused_s = wait_until(lambda: _is_written(site, course), "a write", 120.0)
            time.sleep(BEFORE_S)
        states = states_at_the_end(site.installation, jobs, JOBS_END_WITHIN_S)
        _notify(course, site, askers, written, before, refused_s)
        done = states.count("done")
        course.record("large plans that were taken on", f"{done} of {len(jobs)} done", "all", done == len(jobs))


@contextmanager
def small_disk() -> Iterator[Path]:
    place = Path(tempfile.mkdtemp(prefix="sw-disk-", dir="/tmp"))  # where PostgreSQL's user gets to, and short enough for sockets
    place.chmod(0o755)
    subprocess.run([find_program("mount") or "mount", "-t", "tmpfs", "-o", f"size={SIZE_MIB}m,mode=0755", "tmpfs", str(place)], check=True)  # noqa: S603
    try:
        (place / "state").mkdir()
        yield place
    finally:
        if KEEPS in os.environ:
            shutil.copytree(place / "state" / "log", state_directory() / "chaos" / "disk-log", dirs_exist_ok=True)
        subprocess.run([find_program("umount") or "umount", "--lazy", str(place)], check=True)  # noqa: S603
        place.rmdir()


def _fill(ballast: Path, for_s: float) -> None:
    """To the last byte, and what becomes free meanwhile as well."""
    ends_s = time.monotonic() + for_s
    piece = b"\0" * 65_536
    with ballast.open("ab", buffering=0) as file:
        while time.monotonic() < ends_s:
            try:
                file.write(piece)
            except OSError:
                piece = piece[: max(len(piece) // 2, 512)]
                time.sleep(0.02)
    print(f"{shutil.disk_usage(ballast.parent).free} bytes free", flush=True)


def _question(course: Course, site: Site, number: int, written: list[str], jobs: list[str]) -> Callable[[], str]:
    client, chance = site.client(number), course.chance.__class__(course.seed + number)
    if number == 0:
        return reader(client)

    def ask() -> str:
        if number == 1:
            answer = client.ask("POST", "/api/v1/plans", large_plan_body(site, chance))
            if answer.status == 202:
                jobs.append(job_of(answer.json))
        else:
            answer = client.ask(
                "POST", "/api/v1/missions", {**plan_body(site, chance), "name": "Chaos"}, **{"Idempotency-Key": str(uuid4())}
            )
            if answer.status == 201:
                written.append(str(answer.json["id"]))
        if answer.status == 503:
            return "503 with Retry-After" if int(answer.headers.get("retry-after", "0")) > 0 else "503 without Retry-After"
        return str(answer.status)

    return ask


def _is_written(site: Site, course: Course) -> bool:
    client = site.client(11, keeps=False)
    try:
        return client.ask("POST", "/api/v1/missions", {**plan_body(site, course.chance), "name": "After"}).status == 201
    except (OSError, HTTPException):
        return False


def _notify(course: Course, site: Site, askers: Askers, written: list[str], before: int, refused_s: float) -> None:
    refused = askers.counted["503 with Retry-After"]
    odd = {
        reported: number
        for reported, number in askers.counted.items()
        if reported not in {"200", "201", "202", "429", "503 with Retry-After"}
    }
    figure = f"{refused:,} of {askers.counted.total():,} refused with 503 and Retry-After" + (
        f"; {odd} {askers.faults[:2]}" if odd else ", nothing else"
    )
    course.record("requests to a full disk", figure, "503 with Retry-After, never 500", refused > 0 and not odd)
    lost = sum(one_of(site.installation, "SELECT 1 FROM missions_mission WHERE id = %s", one) is None for one in written)
    course.record(WRITTEN, f"{lost} of {len(written)} lost ({before} before it was full)", "0", not lost and before > 0)
    half = one_of(
        site.installation,
        "SELECT count(*) FROM missions_mission m WHERE NOT EXISTS (SELECT 1 FROM missions_inspectiontarget t WHERE t.mission_id = m.id)",
    )
    course.record(HALF, f"{half}", "0", half == 0)
    course.record("saved again once there is room", f"after {refused_s:.1f} s", "30 s, by itself", refused_s <= 30.0)


if __name__ == "__main__":
    main(run)
