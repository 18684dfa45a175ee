"""Large plans, which workers make: asked for, and waited for."""

import random
from typing import Any

import psycopg

from deploy.load.installation import Installation
from tests.chaos.site import Site, wait_until

LARGE = 16  # targets
UAVS = 2
ENDED = {"done", "failed", "cancelled"}


def large_plan_body(site: Site, chance: random.Random) -> dict[str, Any]:
    return {
        "uavs": chance.sample(site.people["uavs"], UAVS),
        "targets": [{"asset": asset} for asset in chance.sample(site.people["towers"], LARGE)],
        "objective": "total",
        "return_to_start": True,
    }


def job_of(reported: dict[str, Any]) -> str:
    """Its id, of an answer 202."""
    job = reported.get("job", reported)
    return str(job["id"] if isinstance(job, dict) else job)


def states_at_the_end(installation: Installation, jobs: list[str], patience_s: float) -> list[str]:
    """How the jobs ended; those that have not ended in that time as they are then."""
    found: list[str] = []

    def have_ended() -> bool:
        found[:] = [str(one_of(installation, "SELECT state FROM workspace_job WHERE id = %s", job)) for job in jobs]
        return set(found) <= ENDED

    try:
        wait_until(have_ended, "the end of all jobs", patience_s)
    except TimeoutError as error:
        print(error, flush=True)
    return found


def one_of(installation: Installation, statement: str, *values: Any) -> Any:
    """The one value of a statement, over a connection of its own; None where there is no row, or no database."""
    url = installation.settings["DATABASE_URL"].replace("postgis://", "postgresql://", 1)
    try:
        with psycopg.connect(url, connect_timeout=2, autocommit=True) as connection:
            row = connection.execute(statement, values).fetchone()
    except psycopg.OperationalError:
        return None
    return None if row is None else row[0]
