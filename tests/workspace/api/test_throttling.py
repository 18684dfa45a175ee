"""How often a user may ask, with Redis and without."""

import pytest
from redis.exceptions import ConnectionError as RedisConnectionError

from tests.accounts.users import a_user, client_of
from tests.workspace.counters import forget_counts
from workspace.api.throttling import ScopedRate

pytestmark = [pytest.mark.django_db, pytest.mark.urls("tests.workspace.api.echo_urls")]


@pytest.fixture(autouse=True)
def three_an_hour(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ScopedRate, "THROTTLE_RATES", {"plans": "3/hour"})
    forget_counts()


def statuses(number: int = 5) -> list[int]:
    client = client_of(a_user())
    return [client.post("/api/v1/echo", {}, content_type="application/json").status_code for _ in range(number)]


def test_who_asks_too_often_is_told_when_to_come_back() -> None:
    client = client_of(a_user())
    for _ in range(3):
        client.post("/api/v1/echo", {}, content_type="application/json")
    answer = client.post("/api/v1/echo", {}, content_type="application/json")
    assert answer.status_code == 429
    assert answer.json()["error"]["code"] == "throttled"
    assert 0 < int(answer["Retry-After"]) <= 3600


def test_each_user_is_counted_alone() -> None:
    assert statuses() == statuses() == [200, 200, 200, 429, 429]


def test_without_redis_nobody_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    def away(*args: object, **options: object) -> None:
        raise RedisConnectionError("no socket")

    monkeypatch.setattr("workspace.api.throttling._count", away)
    assert statuses() == [200] * 5


def test_views_without_a_scope_are_not_counted() -> None:
    client = client_of(a_user())
    assert {client.get("/api/v1/jobs").status_code for _ in range(5)} == {200}


def test_of_a_generous_limit_the_first_request_that_a_process_sees_is_not_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ScopedRate, "THROTTLE_RATES", {"plans": "20/hour"})
    assert statuses(23) == [200] * 21 + [429] * 2
    assert statuses(23) == [200] * 21 + [429] * 2
