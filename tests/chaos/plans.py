"""The article's question: a plan for two UAVs and four targets, of random towers of the demo region."""

import random
from collections.abc import Callable
from typing import Any

from tests.chaos.asking import Client
from tests.chaos.site import Site

TARGETS, UAVS = 4, 2


def plan_body(site: Site, chance: random.Random) -> dict[str, Any]:
    return {
        "uavs": chance.sample(site.people["uavs"], UAVS),
        "targets": [{"asset": asset} for asset in chance.sample(site.people["towers"], TARGETS)],
        "objective": "total",
        "return_to_start": True,
    }


def planner(site: Site, client: Client, seed: int) -> Callable[[], str]:
    """A question that is a plan; what is counted is its status, and whether it was one."""
    chance = random.Random(seed)

    def ask() -> str:
        answer = client.ask("POST", "/api/v1/plans", plan_body(site, chance))
        if answer.status == 200 and "routes" not in answer.json:
            return "200 without a plan"
        return str(answer.status)

    return ask


def reader(client: Client, path: str = "/api/v1/missions?limit=5") -> Callable[[], str]:
    def ask() -> str:
        return str(client.ask("GET", path).status)

    return ask
