"""The outermost middleware: probes, the request id, and response times."""

import logging
from collections.abc import Callable
from functools import partial
from time import perf_counter
from typing import Any

from django.conf import settings
from django.db import Error as DatabaseError
from django.http import HttpRequest, HttpResponse, JsonResponse
from django.utils.functional import SimpleLazyObject
from django.views.decorators.cache import never_cache
from django.views.decorators.http import require_safe
from prometheus_client import Counter, Histogram

from config.compiled.warming import warming_faults
from inspection.models import Asset, GraphSnapshot
from operation.log_context import ABOUT_REQUEST, REQUEST_ID_HEADER, Facts, about_lazily, sane_request_id
from operation.metrics import REQUEST_SECONDS, REQUESTS
from operation.readiness import NO_DATABASE, database_faults, redis_faults

logger = logging.getLogger("spanwise.request")
METHODS = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"})
NO_ROUTE = "none"
_KWARGS = {"mission_id": "mission", "uav_id": "uav", "job_id": "job"}
_counters: dict[tuple[str, str, int], Counter] = {}
_timers: dict[tuple[str, str], Histogram] = {}


@never_cache
@require_safe
def healthz(request: HttpRequest) -> JsonResponse:
    """Report that the process responds, without checking anything else."""
    return JsonResponse({"alive": True})


@never_cache
@require_safe
def readyz(request: HttpRequest) -> JsonResponse:
    """Return 200 when database, migrations and Redis are available and the process is warm, else 503 with the reasons.

    `missing` is what prevents planning: users supply it, so it does not make the process unready.
    """
    reasons = [*database_faults(), *redis_faults(), *warming_faults()]
    answer: dict[str, Any] = {"ready": not reasons}
    if reasons:
        answer["reasons"] = reasons
    if not reasons and (missing := missing_ground()):
        answer["missing"] = missing
    return JsonResponse(answer, status=503 if reasons else 200)


def missing_ground() -> list[str]:
    """Return the data without which nothing can be planned."""
    try:
        missing = []
        if not Asset.objects.filter(vanished_at=None).exists():
            missing.append("no data is imported")
        if not GraphSnapshot.objects.exists():
            missing.append("no graph is built")
        return missing
    except DatabaseError:
        return [NO_DATABASE]


PROBES: dict[str, Callable[[HttpRequest], HttpResponse]] = {"/healthz": healthz, "/readyz": readyz}


class ObservedRequests:
    """Answers probes before anything else: they come without TLS and to an address that is no host name of this site."""

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
    """Return the context of a request: the view's arguments once its URL is resolved, and the user once loaded."""
    match = request.resolver_match
    named = {} if match is None else {_KWARGS[name]: str(value) for name, value in match.kwargs.items() if name in _KWARGS}
    return {"request": request_id, **_who(request), **named}


def _who(request: HttpRequest) -> Facts:
    """Return the user's key, without loading the user for a log line."""
    user = getattr(request, "user", None)
    if isinstance(user, SimpleLazyObject):
        user = getattr(request, "_cached_user", None)  # where the session's middleware caches the user
    key = getattr(user, "pk", None)
    return {} if key is None else {"user": str(key)}


def _count(request: HttpRequest, status: int, took_s: float) -> None:
    """Count by URL pattern instead of URL: there are as many patterns as lines in urls.py."""
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
