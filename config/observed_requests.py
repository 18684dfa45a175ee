"""The outermost middleware: whether the program lives and can work, the request's own id, and how long each answer took."""

import logging
from collections.abc import Callable
from functools import partial
from time import perf_counter

from django.conf import settings
from django.http import HttpRequest, HttpResponse
from django.utils.functional import SimpleLazyObject
from prometheus_client import Counter, Histogram

from config.health import PROBES
from operation.log_context import ABOUT_REQUEST, REQUEST_ID_HEADER, Facts, about_lazily, sane_request_id
from operation.metrics import REQUEST_SECONDS, REQUESTS

logger = logging.getLogger("spanwise.request")

METHODS = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"})
NO_ROUTE = "none"
_KWARGS = {"mission_id": "mission", "uav_id": "uav", "job_id": "job"}

_counters: dict[tuple[str, str, int], Counter] = {}
_timers: dict[tuple[str, str], Histogram] = {}


class ObservedRequests:
    """Probes are answered before anything else: they come to an address that is no host name of this site, and without TLS."""

    def __init__(self, get_response: Callable[[HttpRequest], HttpResponse]) -> None:
        self.get_response = get_response

    def __call__(self, request: HttpRequest) -> HttpResponse:
        if (probe := PROBES.get(request.path_info)) is not None:
            return probe(request)
        began_s = perf_counter()
        request_id = sane_request_id(request.META.get("HTTP_X_REQUEST_ID"))
        read = partial(facts_of, request, request_id)
        setattr(request, ABOUT_REQUEST, read)
        with about_lazily(read):
            response = self.get_response(request)
            response[REQUEST_ID_HEADER] = request_id
            took_s = perf_counter() - began_s
            _count(request, response.status_code, took_s)
            if settings.LOG_REQUESTS:
                logger.info("%s %s %s %.3f s", request.method, request.path, response.status_code, took_s)
        return response


def facts_of(request: HttpRequest, request_id: str) -> Facts:
    """What is known once the address has been understood, and who asks once they have been looked up."""
    match = request.resolver_match
    named = {} if match is None else {_KWARGS[name]: str(value) for name, value in match.kwargs.items() if name in _KWARGS}
    return {"request": request_id, **_who(request), **named}


def _who(request: HttpRequest) -> Facts:
    """By number. Nobody is looked up for a line of log."""
    user = getattr(request, "user", None)
    if isinstance(user, SimpleLazyObject):
        user = getattr(request, "_cached_user", None)  # where the session's middleware keeps whom it has looked up
    key = getattr(user, "pk", None)
    return {} if key is None else {"user": str(key)}


def _count(request: HttpRequest, status: int, took_s: float) -> None:
    """By the pattern of the address, never by the address: there are as many patterns as lines in urls.py."""
    match = request.resolver_match
    route = NO_ROUTE if match is None else match.route
    method = request.method if request.method in METHODS else "OTHER"
    counter = _counters.get((route, method, status))
    if counter is None:
        counter = _counters[route, method, status] = REQUESTS.labels(route, method, status)
    counter.inc()
    timer = _timers.get((route, method))
    if timer is None:
        timer = _timers[route, method] = REQUEST_SECONDS.labels(route, method)
    timer.observe(took_s)
