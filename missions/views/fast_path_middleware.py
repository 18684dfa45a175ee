"""Middleware: small plans of programs, made before anybody looks for a session, cookies or messages."""

from collections.abc import Callable
from functools import cache

from django.conf import settings
from django.http import HttpRequest, HttpResponse
from django.urls import ResolverMatch, resolve, reverse
from django.utils import translation

from missions.views.fast_path import small_plan
from missions.views.plans import PlanList


class PlansShortWay:
    """Without a cookie there is no session; whoever brings one is answered by the view."""

    def __init__(self, get_response: Callable[[HttpRequest], HttpResponse]) -> None:
        self.get_response = get_response

    def __call__(self, request: HttpRequest) -> HttpResponse:
        asks = request.method == "POST" and request.META.get("HTTP_AUTHORIZATION") and not request.META.get("HTTP_COOKIE")
        answer = _plan(request) if asks and request.path_info == _match()[0] else None
        return self.get_response(request) if answer is None else answer


def _plan(request: HttpRequest) -> HttpResponse | None:
    request.get_host()  # raises DisallowedHost
    with translation.override(translation.get_language_from_request(request)):
        answer = small_plan(request, throttle_scope=PlanList.throttle_scope)
    if answer is not None:
        request.resolver_match = _match()[1]
        answer["X-Frame-Options"] = settings.X_FRAME_OPTIONS
        answer["Content-Length"] = str(len(answer.content))
    return answer


@cache
def _match() -> tuple[str, ResolverMatch]:
    """The address, and what is written at it in urls.py: requests are counted by that."""
    address = reverse("api-plans")
    return address, resolve(address)
