"""Whose pages may open websockets: those of this site, by scheme, host and port."""

from typing import Any

import pytest

from config.live import is_own_origin


@pytest.fixture(autouse=True)
def _hosts(settings: Any) -> None:
    settings.ALLOWED_HOSTS, settings.CSRF_TRUSTED_ORIGINS = ["site.example", "127.0.0.1"], ["https://old.example"]


def asks(origin: str, host: str) -> bool:
    return is_own_origin(origin.encode(), {"headers": [(b"host", host.encode()), (b"origin", origin.encode())]})


def test_pages_of_the_same_scheme_host_and_port_are_let_in(settings: Any) -> None:
    settings.HTTPS = True
    assert asks("https://site.example", "site.example")
    assert asks("https://site.example:8443", "Site.example:8443")
    settings.HTTPS = False
    assert asks("http://127.0.0.1:8000", "127.0.0.1:8000")


@pytest.mark.parametrize(
    ("origin", "host"),
    [
        ("http://site.example", "site.example"),
        ("https://site.example:8443", "site.example"),
        ("https://site.example", "site.example:8443"),
        ("https://127.0.0.1", "site.example"),
        ("https://evil.example", "evil.example"),
        ("https://site.example.evil.example", "site.example"),
        ("null", "site.example"),
        ("", "site.example"),
    ],
)
def test_pages_of_another_scheme_host_or_port_are_not(settings: Any, origin: str, host: str) -> None:
    settings.HTTPS = True
    assert not asks(origin, host)


def test_an_origin_that_the_settings_trust_is_let_in() -> None:
    assert asks("https://old.example", "site.example")
