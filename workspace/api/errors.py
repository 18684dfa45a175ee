"""The shape of every error of the API: {"error": {"code", "message", "details"}}, plus the members of RFC 9457.

The content type is `application/problem+json` for clients that name it in Accept, else `application/json`.
"""

import logging
from http import HTTPStatus
from math import ceil
from typing import Any

from django.core.exceptions import PermissionDenied, RequestDataTooBig, SuspiciousOperation
from django.core.exceptions import ValidationError as DjangoValidationError
from django.db import DataError, InterfaceError, OperationalError
from django.http import Http404, HttpRequest
from django.utils.translation import gettext as _
from rest_framework import exceptions
from rest_framework.request import Request
from rest_framework.response import Response

from workspace.api.throttling import rate_limit_headers

logger = logging.getLogger(__name__)

DATABASE_UNAVAILABLE = (OperationalError, InterfaceError)  # also a cancelled statement or a deadlock: worth a retry
RETRY_AFTER_S = 2
PROBLEM_TYPE = "urn:problem-type:spanwise:"  # followed by the error's code
PROBLEM_JSON = "application/problem+json"


class ApiProblem(exceptions.APIException):
    """An error response, raised by views, which translate the errors of services into it."""

    def __init__(self, status: int, code: str, message: str, *, details: Any = None, retry_after_s: int | None = None) -> None:
        super().__init__(message, code)
        self.status_code = status
        self.code = code
        self.message = message
        self.details = details
        self.retry_after_s = retry_after_s


def error_body(status: int, code: str, message: str, details: Any = None, *, instance: str | None = None) -> dict[str, Any]:
    """Return the body of an error. `instance` is the path of the request, if known (RFC 9457, section 3.1.5)."""
    problem = {"type": PROBLEM_TYPE + code, "title": HTTPStatus(status).phrase, "status": status, "detail": message}
    return {"error": {"code": code, "message": message, "details": details}, **problem} | ({"instance": instance} if instance else {})


def error_content_type(request: HttpRequest | Request | None) -> str:
    """Return `application/problem+json` where the request's Accept names it, else `application/json`."""
    accepted = "" if request is None else request.META.get("HTTP_ACCEPT", "")
    names = {entry.partition(";")[0].strip().lower() for entry in accepted.split(",")}
    return PROBLEM_JSON if PROBLEM_JSON in names else "application/json"


def database_away_problem() -> ApiProblem:
    return ApiProblem(503, "database_away", _("The database cannot be reached. Try again in a moment."), retry_after_s=RETRY_AFTER_S)


def error_response(error: Exception, context: dict[str, Any]) -> Response | None:
    """Handle exceptions for REST framework. Internal errors stay unhandled and reach handler500."""
    error = _as_api_exception(error)
    if not isinstance(error, exceptions.APIException):
        return None
    headers = {}
    if challenge := getattr(error, "auth_header", None):
        headers["WWW-Authenticate"] = challenge
    retry_after_s = getattr(error, "retry_after_s", None) or getattr(error, "wait", None)
    if retry_after_s:
        headers["Retry-After"] = str(ceil(retry_after_s))
    if isinstance(error, exceptions.Throttled) and (scope := getattr(context.get("view"), "throttle_scope", None)):
        headers |= rate_limit_headers(scope, retry_after_s or 0)
    request = context.get("request")
    instance = None if request is None else request.path
    code, message, details = _facts_of(error)
    body = error_body(error.status_code, code, message, details, instance=instance)
    return Response(body, status=error.status_code, headers=headers, content_type=error_content_type(request))


def _facts_of(error: exceptions.APIException) -> tuple[str, str, Any]:
    """Return code, message and details."""
    if isinstance(error, ApiProblem):
        return error.code, error.message, error.details
    if isinstance(error, exceptions.ValidationError):
        faults = _faults(error.detail)
        place, messages = next(iter(faults.items()), ("", ["The input is not valid."]))
        return "invalid", f"{place}: {messages[0]}" if place else messages[0], faults
    return _code(error), str(error.detail), None


def _as_api_exception(error: Exception) -> Exception:
    if isinstance(error, DATABASE_UNAVAILABLE):
        logger.warning("database away: %s", error)
        return database_away_problem()
    if isinstance(error, Http404):
        return exceptions.NotFound(_("There is nothing here, or it belongs to another organisation."))
    if isinstance(error, PermissionDenied):
        return exceptions.PermissionDenied(str(error) or None)
    if isinstance(error, DjangoValidationError):
        return exceptions.ValidationError(error.message_dict if hasattr(error, "error_dict") else error.messages)
    if isinstance(error, RequestDataTooBig):
        return ApiProblem(413, "too_large", _("The request is larger than this address takes."))
    if isinstance(error, SuspiciousOperation):
        return ApiProblem(400, "bad_request", _("The request cannot be read."))
    if isinstance(error, DataError):
        logger.warning("a value does not fit its column: %s", error)
        return ApiProblem(400, "invalid", _("A value is out of the range that can be stored."))
    return error


def _code(error: exceptions.APIException) -> str:
    codes = error.get_codes()
    return codes if isinstance(codes, str) else error.default_code


def _faults(detail: Any, place: str = "") -> dict[str, list[str]]:
    """Flatten nested validation errors: {"targets.0.position": ["This field is required."]}; "" is the body as a whole."""
    if isinstance(detail, dict):
        nested = [(key, value) for key, value in detail.items() if value]
    elif isinstance(detail, list) and any(isinstance(entry, dict | list) for entry in detail):
        nested = [(str(index), entry) for index, entry in enumerate(detail) if entry]
    else:
        return {place: [str(message) for message in (detail if isinstance(detail, list) else [detail])]}
    faults: dict[str, list[str]] = {}
    for key, value in nested:
        inner = place if key == "non_field_errors" else f"{place}.{key}" if place else str(key)
        for where, messages in _faults(value, inner).items():
            faults.setdefault(where, []).extend(messages)
    return faults
