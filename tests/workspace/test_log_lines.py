"""The log names addresses of requests, but no link that lets somebody in."""

import io
import logging.config
from collections.abc import Iterator

import pytest
from django.conf import settings
from django.test import Client
from django.urls import reverse


@pytest.fixture
def log() -> Iterator[io.StringIO]:
    """What the log's handler writes, with the filters that the settings give it."""
    configurator = logging.config.DictConfigurator(settings.LOGGING)
    handler = logging.StreamHandler(stream := io.StringIO())
    for name in settings.LOGGING["handlers"]["console"]["filters"]:
        handler.addFilter(configurator.configure_filter(dict(settings.LOGGING["filters"][name])))
    logging.getLogger().addHandler(handler)
    yield stream
    logging.getLogger().removeHandler(handler)


@pytest.mark.django_db
@pytest.mark.parametrize(("page", "secret"), [("invitation", ["holder-of-the-link"]), ("new-password", ["MQ", "holder-of-the-link"])])
def test_a_refused_request_at_a_link_is_told_without_it(log: io.StringIO, page: str, secret: list[str]) -> None:
    assert Client(enforce_csrf_checks=True).post(reverse(page, args=secret)).status_code == 403
    assert f"/{page}/..." in log.getvalue()
    assert "holder-of-the-link" not in log.getvalue()


@pytest.mark.django_db
def test_other_addresses_are_told_whole(log: io.StringIO) -> None:
    Client().get("/missions/nowhere-at-all")
    assert "/missions/nowhere-at-all" in log.getvalue()
