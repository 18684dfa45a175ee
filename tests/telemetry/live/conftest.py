"""The front door of live pages, with a Redis of its own."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.workspace.front_door import Door, front_door, redis_at, running, through_its_redis, wait_until


@pytest.fixture(scope="package")
def door(django_db_setup: None) -> Iterator[Door]:
    with front_door() as door, door.serves_live():
        wait_until(lambda: door.is_open)
        yield door


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
