"""The front door of live pages, with a Redis of its own."""

from collections.abc import Iterator
from typing import Any

import pytest

from tests.workspace.front_door import Door, front_door, redis_at, running, through_its_redis, wait_until


@pytest.fixture(scope="package")
def door(django_db_setup: None) -> Iterator[Door]:
    with front_door() as door, door.serves_live():
        wait_until(lambda: door.is_open)
        yield door


@pytest.fixture
def here(door: Door, settings: Any) -> Iterator[Door]:
    """The tests' own words go through its Redis as well."""
    through_its_redis(door, settings)
    with running(redis_at(door.redis)):
        wait_until(door.redis.exists)
        yield door
