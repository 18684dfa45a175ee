"""Alive, and able to work: told apart."""

from typing import Any

import pytest
from django.contrib.gis.geos import Point
from django.core.cache import caches
from django.db import OperationalError, connection
from django.db.migrations.recorder import MigrationRecorder
from django.test import Client, override_settings

from inspection.models import Asset, GraphSnapshot
from tests.accounts.users import a_user, client_of

DEAD_REDIS = {"default": {"BACKEND": "django.core.cache.backends.redis.RedisCache", "LOCATION": "unix:///nonexistent/redis.sock"}}
pytestmark = pytest.mark.django_db


@pytest.fixture
def ground() -> None:
    """A tower, and a graph with its one node."""
    place = Point(10.0, 56.0, srid=4326)
    Asset.objects.create(kind="tower", subtype="tower", geometry=place, centre=place)
    counts = dict.fromkeys(["edges", "excluded_nodes", "excluded_edges"], 0)
    GraphSnapshot.objects.create(ground_revision=1, rules={}, nodes=1, components=1, arrays=b"", arrays_sha256="", build_s=0.1, **counts)


def ready() -> tuple[int, Any]:
    answer = Client(raise_request_exception=False).get("/readyz")
    return answer.status_code, answer.json()


def test_alive_asks_nobody(django_assert_num_queries: Any) -> None:
    with django_assert_num_queries(0):
        assert Client().get("/healthz").json() == {"alive": True}


@pytest.mark.usefixtures("ground")
def test_ready_with_data_and_a_graph() -> None:
    assert ready() == (200, {"ready": True})


def test_ready_without_data_for_somebody_has_to_bring_it_in() -> None:
    assert ready() == (200, {"ready": True, "missing": ["no data is imported", "no graph is built"]})


@pytest.mark.usefixtures("ground")
def test_probes_are_answered_at_any_host_name_and_without_tls() -> None:
    with override_settings(SECURE_SSL_REDIRECT=True, ALLOWED_HOSTS=["spanwise.example"]):
        assert Client().get("/healthz", headers={"Host": "10.0.0.7:8000"}).status_code == 200
        assert Client().get("/readyz", headers={"Host": "10.0.0.7:8000"}).status_code == 200
        assert Client().get("/missions", headers={"Host": "spanwise.example"}).status_code == 301


@pytest.mark.usefixtures("ground")
def test_migrations_of_a_newer_version_trouble_nobody() -> None:
    MigrationRecorder(connection).record_applied("missions", "9999_of_tomorrow")
    assert ready() == (200, {"ready": True})


@pytest.mark.usefixtures("ground")
def test_not_ready_before_the_migrations() -> None:
    MigrationRecorder(connection).migration_qs.filter(app="missions").delete()
    assert ready() == (503, {"ready": False, "reasons": ["migrations are not applied"]})


@pytest.mark.usefixtures("ground")
def test_not_ready_without_the_database(monkeypatch: pytest.MonkeyPatch) -> None:
    def away(*args: object) -> None:
        raise OperationalError("connection refused")

    monkeypatch.setattr(MigrationRecorder, "applied_migrations", away)
    assert ready() == (503, {"ready": False, "reasons": ["the database cannot be reached"]})


@pytest.mark.usefixtures("ground")
@pytest.mark.urls("tests.workspace.api.echo_urls")
def test_without_redis_the_api_goes_on_and_ready_says_so() -> None:
    client = client_of(a_user())
    with override_settings(CACHES=DEAD_REDIS):
        assert ready() == (503, {"ready": False, "reasons": ["Redis cannot be reached"]})
        assert Client().get("/healthz").status_code == 200
        assert client.get("/api/v1/assets").status_code == 200
        assert client.post("/api/v1/echo", {}, content_type="application/json").status_code == 200
    assert caches["default"].get("nothing") is None
