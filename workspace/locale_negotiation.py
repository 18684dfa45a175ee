"""In which language somebody is spoken to who has chosen none: that of the browser, by websocket as by HTTP."""

from collections.abc import Mapping
from typing import Any

from django.http import HttpRequest
from django.utils import translation
from django.utils.formats import number_format

from workspace.models import User


def language_of_request(user: User, request: HttpRequest) -> str:
    return user.own_language or translation.get_language_from_request(request)


def language_of_socket(user: User, scope: Mapping[str, Any]) -> str:
    """scope: of a websocket behind the session's middleware."""
    request = HttpRequest()
    request.COOKIES = dict(scope.get("cookies", {}))
    reported = dict(scope.get("headers", [])).get(b"accept-language", b"")
    request.META["HTTP_ACCEPT_LANGUAGE"] = reported.decode("latin-1")
    return language_of_request(user, request)


def number_text(value: float, decimals: int = 0) -> str:
    """ "1,234.5", in German "1.234,5"."""
    return str(number_format(round(value, decimals), decimal_pos=decimals, use_l10n=True, force_grouping=True))
