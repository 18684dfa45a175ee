"""Middleware: query parameters that the OpenAPI document does not name for an operation get a 400.

A mistyped filter would otherwise list everything. The check reads the declaration (`extend_schema`) behind the document.
"""

from collections.abc import Callable
from difflib import get_close_matches
from functools import cache
from itertools import islice
from typing import Any, cast

from django.http import HttpRequest, HttpResponse, JsonResponse
from django.utils.translation import gettext as _
from drf_spectacular.plumbing import force_instance
from drf_spectacular.utils import OpenApiParameter
from rest_framework.views import APIView

from workspace.api.errors import error_body, error_content_type

API = "/api/v1/"
CODE = "unknown_parameter"
MAX_NAMED, MAX_NAME_LENGTH = 10, 100  # limits the search for similar names
HANDLERS = {"GET": "get", "HEAD": "get", "POST": "post", "PUT": "put", "PATCH": "patch", "DELETE": "delete"}


class KnownQueryParameters:
    def __init__(self, get_response: Callable[[HttpRequest], HttpResponse]) -> None:
        self.get_response = get_response

    def __call__(self, request: HttpRequest) -> HttpResponse:
        return self.get_response(request)

    def process_view(self, request: HttpRequest, view: Any, _args: Any, _kwargs: Any) -> HttpResponse | None:
        """Return 400 for an unknown parameter; None lets the view answer."""
        if not request.META.get("QUERY_STRING") or not request.path_info.startswith(API):
            return None
        view_class, method = getattr(view, "cls", None), HANDLERS.get(request.method or "")
        if view_class is None or method is None or not hasattr(view_class, method):
            return None
        known = query_parameters_of(view_class, method)
        unknown = islice((name for name in request.GET if name not in known), MAX_NAMED)
        faults = {name[:MAX_NAME_LENGTH]: [_fault(name[:MAX_NAME_LENGTH], known)] for name in unknown}
        if not faults:
            return None
        place, [message] = next(iter(faults.items()))
        body = error_body(400, CODE, f"{place}: {message}", faults, instance=request.path)
        return JsonResponse(body, status=400, content_type=error_content_type(request))


@cache
def query_parameters_of(view_class: type[APIView], method: str) -> frozenset[str]:
    """Return the names that an operation declares; `method` is the name of its handler."""
    declaration = getattr(getattr(view_class, method), "kwargs", {}).get("schema")
    if declaration is None:
        return frozenset()
    schema, view = declaration(), cast(Any, view_class())
    view.request, view.kwargs = None, {}  # drf-spectacular reads them from the view
    schema.view, schema.method, schema.path = view, method.upper(), ""
    return frozenset(name for parameter in schema.get_override_parameters() for name in _names_of(parameter))


def _names_of(parameter: Any) -> list[str]:
    """Return the query parameters of an OpenApiParameter or of a serializer, whose fields are parameters."""
    if isinstance(parameter, OpenApiParameter):
        return [parameter.name] if parameter.location == OpenApiParameter.QUERY else []
    return list(force_instance(parameter).fields)


def _fault(name: str, known: frozenset[str]) -> str:
    if not known:
        return _("There is no such parameter. This address knows none.")
    names = ", ".join(sorted(known))
    if near := get_close_matches(name, known, 1):
        return _("There is no such parameter. Did you mean {near}? Known ones are {known}.").format(near=near[0], known=names)
    return _("There is no such parameter. Known ones are {known}.").format(known=names)
