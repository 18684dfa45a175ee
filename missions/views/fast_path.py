"""The shortest way from a request to a small plan.

Most requests of a busy installation are the same: a bearer token or a session, a plain body of a few targets. REST framework's ceremony
costs such a request as much as its plan. Here the same functions are asked in the same order - who is it, may they, is the body what it
should be, is it too often - and wherever an answer is not a plain yes, the view begins anew and says what is wrong.
"""

from typing import Any

import orjson
from django.conf import settings
from django.http import HttpRequest, HttpResponse
from rest_framework.exceptions import APIException

from inspection.selectors import NoGraph
from missions import services
from missions.serializers.plain_request import plain_request
from workspace.api.authentication import holder_of, holder_of_session
from workspace.api.errors import DATABASE_UNAVAILABLE
from workspace.api.parsers import read_json
from workspace.api.permissions import PLANNERS
from workspace.api.throttling import ScopedRate
from workspace.jobs.planning_lock import in_turn
from workspace.models import TokenScope

MAX_BODY = 64 * 1024
_ORDINARY_ACCEPT = frozenset({"*/*", "application/json"})
_BEGIN_ANEW = (APIException, services.InvalidRequest, NoGraph, services.GraphOutdated, *DATABASE_UNAVAILABLE)


def small_plan(request: HttpRequest, *, throttle_scope: str) -> HttpResponse | None:
    """The plan as JSON; None where the view has to look at the request itself. A request that fails after it was counted counts twice."""
    if not _is_ordinary(request):
        return None
    body = request.body  # which may come slowly: nobody waits for that in a turn
    try:
        with in_turn():
            plan = _plan_of(request, body, throttle_scope)
            return None if plan is None else HttpResponse(orjson.dumps(plan, default=str), content_type="application/json")
    except _BEGIN_ANEW:
        return None


def _plan_of(request: HttpRequest, body: bytes, throttle_scope: str) -> dict[str, Any] | None:
    authorization = request.META.get("HTTP_AUTHORIZATION")
    holder = holder_of_session(request) if authorization is None else holder_of(authorization)
    if holder is None or holder.role not in PLANNERS or not (holder.scopes is None or TokenScope.PLAN in holder.scopes):
        return None
    asked = plain_request(read_json(body))
    if asked is None or len(asked.targets) > settings.ROUTING_RULES.small_plan_targets:
        return None
    if not ScopedRate.allows(throttle_scope, holder.key):
        return None
    return services.make_plan(request=asked, as_text=True)


def _is_ordinary(request: HttpRequest) -> bool:
    told = request.META
    length = told.get("CONTENT_LENGTH", "")
    return (
        request.method == "POST"
        and told.get("CONTENT_TYPE") == "application/json"
        and length.isdecimal()
        and int(length) <= MAX_BODY
        and told.get("HTTP_ACCEPT", "*/*") in _ORDINARY_ACCEPT
        and "HTTP_IDEMPOTENCY_KEY" not in told
        and "HTTP_PREFER" not in told
        and not told.get("QUERY_STRING")
    )
