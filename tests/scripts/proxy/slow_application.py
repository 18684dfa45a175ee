"""A small WSGI application: quick answers, and slow ones that are still under way when the program is told to stop."""

import time
from collections.abc import Callable, Iterable

SLOW_S = 3.0


def application(environ: dict[str, object], start_response: Callable[[str, list[tuple[str, str]]], object]) -> Iterable[bytes]:
    is_slow = str(environ["PATH_INFO"]).endswith("/slow")
    if is_slow:
        time.sleep(SLOW_S)
    body = b"slow" if is_slow else b"quick"
    start_response("200 OK", [("Content-Type", "text/plain"), ("Content-Length", str(len(body)))])
    return [body]
