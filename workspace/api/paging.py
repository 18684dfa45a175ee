"""Cursor paging: a page continues after the last row of the previous one, so that inserted or deleted rows cause no repeats or gaps."""

import base64
import binascii
import json
from collections.abc import Callable, Collection
from dataclasses import dataclass
from datetime import UTC, datetime, time, timedelta
from typing import Any, Generic, TypeVar

from django.conf import settings
from django.core.exceptions import ValidationError as DjangoValidationError
from django.db.models import Model, Q, QuerySet
from django.utils.dateparse import parse_date, parse_datetime
from django.utils.translation import gettext as _
from rest_framework.request import Request

from workspace.api.errors import ApiProblem
from workspace.api.whole_numbers import WholeNumber

Row = TypeVar("Row", bound=Model)
Item = TypeVar("Item")
EARLIEST = datetime(2, 1, 1, tzinfo=UTC)  # older than any change, with room to subtract a year
LIMIT = WholeNumber("limit", "rows a page; 100 unless told, 1,000 at most")


@dataclass(frozen=True)
class Page(Generic[Row]):
    rows: list[Row]
    next: str | None  # path and query of the next page


def page_of(
    request: Request, queryset: QuerySet[Any, Row], *, order: tuple[str, ...] = ("pk",), default_limit: int = 100, max_limit: int = 1000
) -> Page[Row]:
    """Return the page of `?limit=` and `?cursor=`.

    `order` names model fields or annotations ("-" for descending); the last one must be unique.
    """
    limit = _limit(request, default_limit, max_limit)
    if cursor := request.query_params.get("cursor"):
        queryset = queryset.filter(_rows_after(queryset, order, cursor))
    rows = list(queryset.order_by(*order)[: limit + 1])
    if len(rows) <= limit:
        return Page(rows, None)
    rows = rows[:limit]
    query = request.query_params.copy()
    query["cursor"] = _cursor_of(queryset, rows[-1], order)
    return Page(rows, f"{request.path}?{query.urlencode()}")


@dataclass(frozen=True)
class Slice(Generic[Item]):
    items: list[Item]
    next: str | None  # path and query of the next page


def slice_of(
    request: Request, read: Callable[[tuple[datetime, str] | None, int], list[Item]], place: Callable[[Item], tuple[datetime, str]]
) -> Slice[Item]:
    """Return the page of `?limit=` and `?cursor=` for items outside of a queryset: `read` returns a number of items after a place.

    A place is the time and the key of an item, and is unique. Raises ApiProblem 400.
    """
    limit = _limit(request, 100, 1000)
    items = read(_place_of(request.query_params.get("cursor", "")), limit + 1)
    if len(items) <= limit:
        return Slice(items, None)
    items = items[:limit]
    at, key = place(items[-1])
    query = request.query_params.copy()
    query["cursor"] = _encoded([at.isoformat(), key])
    return Slice(items, f"{request.path}?{query.urlencode()}")


def _place_of(cursor: str) -> tuple[datetime, str] | None:
    if not cursor:
        return None
    try:
        at, key = _decoded(cursor)
        found = datetime.fromisoformat(at)
    except (binascii.Error, ValueError, TypeError, RecursionError) as error:
        raise _wrong_cursor() from error
    if found.tzinfo is None or not isinstance(key, str) or "\0" in key:
        raise _wrong_cursor()
    return found, key


def changed_since(request: Request, queryset: QuerySet[Any, Row]) -> QuerySet[Any, Row]:
    """Return the rows with an `updated_at` not before `?changed_since=`, and those whose transaction may have ended after it.

    A row's `updated_at` is the start of its transaction, and imports have long ones: rows may come twice, but never get lost. Raises
    ApiProblem 400.
    """
    since = asked_instant(request, "changed_since")
    longest = timedelta(seconds=settings.CELERY_TASK_TIME_LIMIT)
    if since is None or since < EARLIEST:
        return queryset
    return queryset.filter(updated_at__gte=since - longest)


def asked_instant(request: Request, name: str) -> datetime | None:
    """Return the moment of a query parameter; None without one. A date means its first moment; without an offset it is UTC."""
    text = request.query_params.get(name, "")
    if not text:
        return None
    try:
        day = parse_date(text)
        at = datetime.combine(day, time(), tzinfo=UTC) if day else parse_datetime(text)
    except ValueError:
        at = None
    if at is None:
        fault = _("A date or a time in ISO 8601 is needed.")
        raise ApiProblem(400, "invalid", f"{name}: {fault}", details={name: [fault]})
    return at if at.tzinfo else at.replace(tzinfo=UTC)


def asked_flag(request: Request, name: str) -> bool | None:
    """Return a boolean query parameter; None without one. Raises ApiProblem 400 for other values."""
    text = asked_choice(request, name, ("true", "false"))
    return text == "true" if text else None


def asked_choice(request: Request, name: str, known: Collection[str]) -> str:
    """Return the value of a query parameter; empty without one. Raises ApiProblem 400 for an unknown value."""
    text = request.query_params.get(name, "")
    if text and text not in known:
        fault = _("Known are {names}.").format(names=", ".join(known))
        raise ApiProblem(400, "invalid", f"{name}: {fault}", details={name: [fault]})
    return text


def _limit(request: Request, default_limit: int, max_limit: int) -> int:
    return min(LIMIT.asked(request) or default_limit, max_limit)


def _field(queryset: QuerySet[Any], name: str) -> Any:
    name = name.removeprefix("-")
    if annotation := queryset.query.annotations.get(name):
        return annotation.output_field
    return queryset.model._meta.pk if name == "pk" else queryset.model._meta.get_field(name)


def _cursor_of(queryset: QuerySet[Any], row: Model, order: tuple[str, ...]) -> str:
    values = []
    for name in order:
        plain = name.removeprefix("-")
        is_annotation = plain in queryset.query.annotations  # whose output field may be that of a column
        values.append(str(getattr(row, plain)) if is_annotation else _field(queryset, name).value_to_string(row))
    return _encoded(values)


def _encoded(values: list[str]) -> str:
    return base64.urlsafe_b64encode(json.dumps(values).encode()).decode().rstrip("=")


def _decoded(cursor: str) -> Any:
    """Decode a cursor. Raises ValueError (including binascii.Error) or RecursionError; also for an unpaired surrogate."""
    found = json.loads(base64.urlsafe_b64decode(cursor + "=" * (-len(cursor) % 4)))
    json.dumps(found, ensure_ascii=False).encode()
    return found


def _wrong_cursor() -> ApiProblem:
    return ApiProblem(400, "invalid_cursor", _("The cursor is not one that this address gave."))


def _rows_after(queryset: QuerySet[Any], order: tuple[str, ...], cursor: str) -> Q:
    """Return (a, b) > (x, y) written as a > x or (a = x and b > y), each column in its own direction."""
    try:
        texts = _decoded(cursor)
        values = [_field(queryset, name).to_python(str(text)) for name, text in zip(order, texts, strict=True)]
    except (binascii.Error, ValueError, TypeError, OverflowError, RecursionError, DjangoValidationError) as error:
        raise _wrong_cursor() from error
    after = Q()
    equal = Q()
    for name, value in zip(order, values, strict=True):
        column = name.removeprefix("-")
        after |= equal & Q(**{f"{column}__{'lt' if name.startswith('-') else 'gt'}": value})
        equal &= Q(**{column: value})
    return after
