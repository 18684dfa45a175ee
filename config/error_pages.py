"""Responses to uncaught errors: JSON under /api/, a page elsewhere."""

import sys
from http import HTTPStatus

from django.core.exceptions import RequestDataTooBig
from django.db import DataError
from django.http import HttpRequest, HttpResponse, JsonResponse
from django.template import TemplateDoesNotExist
from django.template.loader import render_to_string

from workspace.api.errors import DATABASE_UNAVAILABLE, RETRY_AFTER_S, error_body, error_content_type

API_MESSAGES = {
    400: ("bad_request", "The request cannot be read."),
    403: ("permission_denied", "This is not allowed."),
    404: ("not_found", "There is nothing at this address."),
    413: ("too_large", "The request is larger than this address takes."),
    500: ("server_error", "Something went wrong here. It has been logged."),
    503: ("database_away", "The database cannot be reached. Try again in a moment."),
}


def bad_request(request: HttpRequest, exception: Exception | None = None) -> HttpResponse:
    return _answer(request, 413 if isinstance(exception, RequestDataTooBig) else 400)


def permission_denied(request: HttpRequest, exception: Exception | None = None) -> HttpResponse:
    return _answer(request, 403)


def not_found(request: HttpRequest, exception: Exception | None = None) -> HttpResponse:
    return _answer(request, 404)


def server_error(request: HttpRequest) -> HttpResponse:
    """Respond to the exception that Django is handling: 503 for an unavailable database, 400 for an unstorable value, else 500."""
    error = sys.exc_info()[1]
    if isinstance(error, DataError):
        return _answer(request, 400)  # such as a NUL character in the URL of a filtered list
    return _answer(request, 503 if isinstance(error, DATABASE_UNAVAILABLE) else 500)


def _answer(request: HttpRequest, status: int) -> HttpResponse:
    if request.path.startswith("/api/"):
        response: HttpResponse = JsonResponse(
            error_body(status, *API_MESSAGES[status], instance=request.path), status=status, content_type=error_content_type(request)
        )
    else:
        response = HttpResponse(_page(status), status=status)
    if status == 503:
        response["Retry-After"] = str(RETRY_AFTER_S)
    return response


def _page(status: int) -> str:
    """Return the designed page, rendered without the request: context processors would query the database, which may have failed."""
    try:
        return render_to_string(f"{status}.html")
    except TemplateDoesNotExist:
        return f"<!doctype html><html lang=en><title>{status}</title><p>{HTTPStatus(status).phrase}"
