"""A small application for granian: says which port it was reached at."""

from collections.abc import Callable, Iterable
from typing import Any


def application(environment: dict[str, Any], start: Callable[..., Any]) -> Iterable[bytes]:
    start("200 OK", [("Content-Type", "text/plain")])
    return [environment["wsgi.url_scheme"].encode()]
