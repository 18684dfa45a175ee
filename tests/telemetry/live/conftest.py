"""The front door of live pages, with a Redis of its own."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.workspace.live.proxied_site import Door, front_door, redis_at, running, through_its_redis, wait_until


@pytest.fixture(scope="package")
def closed_door(django_db_setup: None) -> Iterator[Door]:
    with front_door() as door:
        yield door


@pytest.fixture(scope="package")
def live_program(closed_door: Door) -> Iterator[int]:
    """The process that keeps those which serve; it starts another when one is killed."""
    with closed_door.serves_live() as program:
        wait_until(lambda: closed_door.is_open)
        yield program.pid


@pytest.fixture
def door(closed_door: Door, live_program: int) -> Door:
    return closed_door


@pytest.fixture
def without_redis(door: Door, settings: Any, tmp_path: Path) -> Door:
    """The tests' own words go through its Redis as well, once a test has started one."""
    through_its_redis(door, settings)
    settings.GRAPH_CACHE_DIR = tmp_path / "graphs"
    return door


@pytest.fixture
def here(without_redis: Door) -> Iterator[Door]:
    with running(redis_at(without_redis.redis)):
        wait_until(without_redis.redis.exists)
        yield without_redis
