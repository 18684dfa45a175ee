"""The database really cannot be reached: who asks is told to try again, and nothing else breaks."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from django.db import connection
from django.test import Client

from tests.accounts.users import a_user, client_of
from workspace.models import Role

pytestmark = pytest.mark.django_db(transaction=True)

PAGES = ["/", "/missions/new", "/live", "/uavs", "/assets", "/findings", "/zones", "/imports", "/account", "/administration", "/admin/"]
API = ["/api/v1/missions", "/api/v1/uavs", "/api/v1/assets", "/api/v1/zones", "/api/v1/jobs", "/api/v1/alerts", "/api/v1/live",
       "/api/v1/users"]  # fmt: skip


@pytest.fixture
def signed_in(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Client]:
    """An administrator whose session is there, as the database is not any more."""
    client = client_of(a_user(Role.ADMINISTRATOR))
    with monkeypatch.context() as away:
        connection.close()
        away.setitem(connection.settings_dict, "HOST", str(tmp_path))
        yield client
        connection.close()


@pytest.mark.parametrize("address", [*PAGES, *API])
def test_who_asks_is_told_to_try_again(signed_in: Client, address: str) -> None:
    answer = signed_in.get(address)
    assert (answer.status_code, int(answer["Retry-After"]) > 0) == (503, True)
    assert answer["X-Request-ID"]
    assert str(signed_in.get(address).content).count("Traceback") == 0


def test_what_is_sent_meanwhile_is_told_so_too(signed_in: Client) -> None:
    for address in ("/api/v1/plans", "/api/v1/missions"):
        answer = signed_in.post(address, {}, content_type="application/json")
        assert (answer.status_code, int(answer["Retry-After"]) > 0) == (503, True)
    answer = Client().post(
        "/api/v1/uav-link/telemetry", "{}", content_type="application/json", headers={"Authorization": "Bearer spu_some"}
    )
    assert (answer.status_code, int(answer["Retry-After"]) > 0) == (503, True)


def test_the_program_lives_and_says_that_it_cannot_work(signed_in: Client) -> None:
    assert signed_in.get("/healthz").status_code == 200
    answer = signed_in.get("/readyz")
    assert (answer.status_code, answer.json()["reasons"]) == (503, ["the database cannot be reached"])
