"""The article's question: a plan for two UAVs and four targets, of random towers of the demo region."""

import random
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any
from uuid import uuid4

from tests.chaos.asking import Client
from tests.chaos.site import Site

TARGETS, UAVS = 4, 2
SAVED_AS, MAX_TRIES = "Chaos", 40


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


@dataclass
class Saver:
    """A question that saves a mission. One that died with its replica is asked again under the same key, as pages do."""

    site: Site
    client: Client
    seed: int
    saved: list[str] = field(default_factory=list)
    again: int = 0

    def __post_init__(self) -> None:
        self._chance = random.Random(self.seed)

    def __call__(self) -> str:
        key, body = str(uuid4()), plan_body(self.site, self._chance) | {"name": SAVED_AS}
        for _ in range(MAX_TRIES):
            answer = self.client.ask("POST", "/api/v1/missions", body, **{"Idempotency-Key": key})
            if answer.status != 503:
                break
            self.again += 1
            time.sleep(0.5)
        if answer.status == 201:
            self.saved.append(str(answer.json["id"]))
            return "200"
        return f"saving: {answer.status}"


def reader(client: Client, path: str = "/api/v1/missions?limit=5") -> Callable[[], str]:
    def ask() -> str:
        return str(client.ask("GET", path).status)

    return ask
