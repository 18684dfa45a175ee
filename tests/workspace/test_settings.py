"""What the settings make of the environment."""

import os
import subprocess
import sys

import pytest
import redis
from celery import Celery
from django.conf import settings
from django.test import override_settings

from config.private_servers import broker_url
from tests.accounts.users import a_user, client_of


@pytest.mark.parametrize(
    ("redis_url", "celerys"),
    [
        ("unix:///run/redis.sock", "redis+socket:///run/redis.sock?virtual_host=0"),
        ("unix:///run/redis.sock?db=11", "redis+socket:///run/redis.sock?virtual_host=11"),
        ("unix://:secret@/run/redis.sock?db=3", "redis+socket://:secret@/run/redis.sock?virtual_host=3"),
        ("redis://host:6379/2", "redis://host:6379/2"),
    ],
)
def test_a_redis_is_named_to_celery_in_its_own_words(redis_url: str, celerys: str) -> None:
    assert broker_url(redis_url) == celerys


def test_celery_and_the_cache_use_the_same_database_of_the_same_redis() -> None:
    with Celery("test", broker=settings.CELERY_BROKER_URL, set_as_current=False).connection_for_write() as connection:
        celerys = connection.default_channel.client.connection_pool.connection_kwargs
        caches = redis.from_url(settings.REDIS_URL).connection_pool.connection_kwargs
        for name in ("path", "host", "port", "password"):
            assert celerys.get(name) == caches.get(name)
        assert int(celerys.get("db") or 0) == int(caches.get("db") or 0)


@pytest.mark.django_db
def test_a_session_of_the_key_before_holds_while_that_key_is_named() -> None:
    with override_settings(SECRET_KEY="the-key-of-before", SECRET_KEY_FALLBACKS=[]):
        client = client_of(a_user())
        assert client.get("/account").status_code == 200
    with override_settings(SECRET_KEY="the-key-of-today", SECRET_KEY_FALLBACKS=["the-key-of-before"]):
        assert client.get("/account").status_code == 200
    with override_settings(SECRET_KEY="the-key-of-tomorrow", SECRET_KEY_FALLBACKS=[]):
        assert client.get("/account").status_code == 302


def _application_name(environment: dict[str, str]) -> str:
    line = "from django.conf import settings; print(settings.DATABASES['default']['OPTIONS']['application_name'])"
    environment = {**os.environ, "DJANGO_SETTINGS_MODULE": "config.settings", **environment}
    return subprocess.check_output([sys.executable, "-c", line], cwd=settings.BASE_DIR, env=environment, text=True).strip()  # noqa: S603


@pytest.mark.long
def test_the_database_is_told_which_program_holds_a_connection() -> None:
    url = "postgis://somebody@localhost/spanwise"
    assert _application_name({"SPANWISE_PROGRAM": "gateway", "DATABASE_URL": url}) == "gateway"
    assert _application_name({"SPANWISE_PROGRAM": "gateway", "DATABASE_URL": f"{url}?application_name=north"}) == "north"


@pytest.mark.long
def test_over_https_cookies_are_bound_to_the_host() -> None:
    """Browsers take a __Host- cookie from the host itself alone, over TLS, for the whole site."""
    names = ("SESSION_COOKIE_NAME", "CSRF_COOKIE_NAME", "SESSION_COOKIE_SECURE", "SESSION_COOKIE_DOMAIN")
    lines = f"from django.conf import settings; print(*(getattr(settings, name) for name in {names}))"
    reported = {
        https: subprocess.run(  # noqa: S603
            [sys.executable, "-c", lines],
            cwd=settings.BASE_DIR,
            env={**os.environ, "DJANGO_SETTINGS_MODULE": "config.settings", "SPANWISE_HTTPS": https},
            capture_output=True,
            text=True,
            check=True,
        ).stdout.strip()
        for https in ("1", "0")
    }
    assert reported == {"1": "__Host-sessionid __Host-csrftoken True None", "0": "sessionid csrftoken False None"}
