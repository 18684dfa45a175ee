"""Parsers of request bodies: strict JSON within limits."""

import json
import math
import re
from collections.abc import Mapping
from typing import IO, Any

from django.conf import settings
from django.utils.translation import gettext as _
from rest_framework.exceptions import ParseError
from rest_framework.parsers import BaseParser

from workspace.api.errors import ApiProblem

MAX_NESTING_DEPTH = 32
_UNSTORABLE = re.compile("[\0\ud800-\udfff]")
# Users type newlines and tabs. Other control characters, and those that change the direction of writing, make one name look like another.
_REFUSED = re.compile("[\0-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff]")


class StrictJSONParser(BaseParser):
    """Refuses NaN and infinities, deep nesting, characters that cannot be stored, and bodies over the limit."""

    media_type = "application/json"
    finite_only = True
    takes_control_characters = False

    def parse(self, stream: IO[bytes], media_type: str | None = None, parser_context: Mapping[str, Any] | None = None) -> Any:
        limit = settings.DATA_UPLOAD_MAX_MEMORY_SIZE
        body = stream.read(limit + 1)
        if len(body) > limit:
            raise ApiProblem(413, "too_large", _("The request body is larger than %(value)s kB.") % {"value": limit // 1024})
        return read_json(body, finite_only=self.finite_only, takes_control_characters=self.takes_control_characters)


class UavJSONParser(StrictJSONParser):
    """Accepts control characters: a UAV's report on a command counts even with a garbled reason."""

    takes_control_characters = True


class MeasuredJSONParser(UavJSONParser):
    """Accepts NaN and infinities too, for views that name the invalid record and accept the others."""

    finite_only = False


def read_json(body: bytes, *, finite_only: bool = True, takes_control_characters: bool = False) -> Any:
    """Return the value of a JSON body. Raises ParseError."""
    rules: dict[str, Any] = {"parse_constant": _refuse_constant, "parse_float": _finite_float} if finite_only else {}
    try:
        text = body.decode()
        value = json.loads(text, **rules)
    except UnicodeDecodeError as error:
        raise ParseError(_("The body is not UTF-8 at byte %(start)s.") % {"start": error.start}) from error
    except RecursionError as error:
        raise ParseError(
            _("The body is nested deeper than %(deepest_nesting)s levels.") % {"deepest_nesting": MAX_NESTING_DEPTH}
        ) from error
    except ValueError as error:
        raise ParseError(_("The body is not JSON: %(error)s") % {"error": error}) from error
    refused = _UNSTORABLE if takes_control_characters else _REFUSED
    may_be_deep = text.count("[") + text.count("{") > MAX_NESTING_DEPTH
    if may_be_deep or "\\" in text or refused.search(text):
        _check(value, refused)
    return value


class OctetParser(BaseParser):
    """The raw bytes of a part of a file, within the limit of one request."""

    media_type = "application/octet-stream"

    def parse(self, stream: IO[bytes], media_type: str | None = None, parser_context: Mapping[str, Any] | None = None) -> Any:
        limit = settings.DATA_UPLOAD_MAX_MEMORY_SIZE
        body = stream.read(limit + 1)
        if len(body) > limit:
            raise ApiProblem(413, "too_large", _("The request body is larger than %(value)s kB.") % {"value": limit // 1024})
        return body


def _refuse_constant(name: str) -> float:
    raise ValueError(_("%(name)s is not a number") % {"name": name})


def _finite_float(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(_("%(value)s is too large a number") % {"value": text[:20]})
    return value


def _check(root: Any, refused: re.Pattern[str]) -> None:
    """Check the values level by level, so that depth uses no stack."""
    level = [root]
    for _depth in range(MAX_NESTING_DEPTH + 1):
        holders = []
        for value in level:
            if isinstance(value, dict | list):
                holders.append(value)
            elif isinstance(value, str) and refused.search(value):
                raise ParseError(_("A text holds a control character or half a surrogate pair."))
        if not holders:
            return
        level = [inner for holder in holders for inner in ((*holder.keys(), *holder.values()) if isinstance(holder, dict) else holder)]
    raise ParseError(_("The body is nested deeper than %(deepest_nesting)s levels.") % {"deepest_nesting": MAX_NESTING_DEPTH})
