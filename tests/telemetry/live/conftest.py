"""The front door of live pages, with a Redis of its own."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.workspace.live.proxied_site import Endpoint, front_endpoint, redis_at, running, through_its_redis, wait_until


@pytest.fixture(scope="package")
def closed_endpoint(django_db_setup: None) -> Iterator[Endpoint]:
    with front_endpoint() as endpoint:
        yield endpoint


@pytest.fixture(scope="package")
def live_program(closed_endpoint: Endpoint) -> Iterator[int]:
    """The process that keeps those which serve; it starts another when one is killed."""
    with closed_endpoint.serves_live() as program:
        wait_until(lambda: closed_endpoint.is_open)
        yield program.pid


@pytest.fixture
def endpoint(closed_endpoint: Endpoint, live_program: int) -> Endpoint:
    return closed_endpoint


@pytest.fixture
def without_redis(endpoint: Endpoint, settings: Any, tmp_path: Path) -> Endpoint:
    """The tests' own words go through its Redis as well, once a test has started one."""
    through_its_redis(endpoint, settings)
    settings.GRAPH_CACHE_DIR = tmp_path / "graphs"
    return endpoint


@pytest.fixture
def here(without_redis: Endpoint) -> Iterator[Endpoint]:
    with running(redis_at(without_redis.redis)):
        wait_until(without_redis.redis.exists)
        yield without_redis
