"""Which process holds a row until when, by a lease, and which transaction alone does something, by a lock.

What a killed process held is soon another's. A row that can be held has `lease_expires_at` and `holder`: "name/run", where the name stays
the same at every start of one process. Times are the database's, so that the clocks of machines do not matter. Whatever a holder writes
into its row is conditional on its being the holder, or, for a job, on the attempt: a process that lost its lease without noticing changes
nothing.
"""

import os
import re
import secrets
import socket
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from typing import Any, TypeVar

from django.core.exceptions import EmptyResultSet
from django.db import connection
from django.db.models import Model, Q, QuerySet
from django.db.models.expressions import CombinedExpression
from django.db.models.functions import Now
from django.db.models.sql import UpdateQuery
from django.utils import timezone

SURE_SHARE = 0.8  # of a lease: clocks do not run quite alike, and what is on its way still arrives
_Row = TypeVar("_Row", bound=Model)


@dataclass(frozen=True, kw_only=True)
class HolderOptions:
    """`name` is the same at every start of one process, and no other's; `run` and `holder` are of this run alone."""

    name: str
    run: str = field(default_factory=lambda: secrets.token_hex(4))
    lease_s: float = 10.0  # what a killed process held is taken over within this

    @property
    def holder(self) -> str:
        return f"{self.name}/{self.run}"


def holder_name(configured: str | None) -> str:
    """Return the name as holders may have it; without one, a name of this process alone: two on a machine are two."""
    return re.sub(r"[^\w.-]", "-", configured or f"{socket.gethostname()}-{os.getpid()}")[:80]


def held_until_s(asked_s: float, lease_s: float) -> float:
    """Until when a lease that was asked for at a time, and granted, is surely nobody else's; monotonic seconds."""
    return asked_s + SURE_SHARE * lease_s


def from_now(seconds: float) -> CombinedExpression:
    """A time by the database's clock, for the queries of this module's callers."""
    return Now() + timedelta(seconds=seconds)


def has_run_out(lease_expires_at: datetime | None) -> bool:
    """Of a row that was read just now: whether nobody holds it."""
    return lease_expires_at is None or lease_expires_at < timezone.now()


def is_free() -> Q:
    """Rows that nobody holds, or whose holder has not renewed its lease."""
    return Q(lease_expires_at=None) | Q(lease_expires_at__lt=Now())


def is_free_for(holder: str, *, lease_s: float, namesake_s: float | None = None) -> Q:
    """As is_free, and rows of the same process, started again: at once, or after `namesake_s` without renewal.

    With `namesake_s`, two processes that run under one name by mistake do not take rows from each other.
    """
    namesake = Q(holder__startswith=f"{holder.rsplit('/', 1)[0]}/")
    if namesake_s is not None:
        namesake &= Q(lease_expires_at__lt=from_now(lease_s - namesake_s))
    return is_free() | Q(holder__in=["", holder]) | namesake


def take(rows: QuerySet[_Row], *, holder: str, lease_s: float, skip_locked: bool = False, **changes: Any) -> list[_Row]:
    """Hold these rows, of which the caller has left only those that may be taken, and return them as they are then.

    Of two processes that ask at once one has a row. skip_locked: rows that others write just now are left instead of waited for.
    """
    found = _update(rows, {"holder": holder, "lease_expires_at": from_now(lease_s), **changes}, skip_locked=skip_locked)
    return [] if found is None else list(rows.model._default_manager.raw(f"{found[0]}.*", found[1]))


def renew(held: QuerySet[Any], *, lease_s: float, column: str = "pk") -> dict[Any, Any]:
    """Extend the leases of rows; by the key of each that is still held, the value of a column."""
    found = _update(held, {"lease_expires_at": from_now(lease_s)})
    if found is None:
        return {}
    key = held.model._meta.pk.column
    value = key if column == "pk" else held.model._meta.get_field(column).column
    with connection.cursor() as cursor:
        cursor.execute(f"{found[0]}.{_quoted(key)}, {_quoted(held.model._meta.db_table)}.{_quoted(value)}", found[1])
        return dict(cursor.fetchall())


def release(held: QuerySet[Any], *, after_s: float = 0.0, **changes: Any) -> int:
    """Anybody may take these rows from now on, or after so many seconds. Returns how many there were."""
    return held.update(lease_expires_at=from_now(after_s) if after_s else None, **changes)


def _update(rows: QuerySet[Any], values: dict[str, Any], *, skip_locked: bool = False) -> tuple[str, tuple[Any, ...]] | None:
    """An update up to the table's name after RETURNING, and its parameters; None where there can be no such row.

    One statement, which needs no transaction; rows are locked in the order of the queryset, or of their keys, so that no two processes
    wait for each other.
    """
    meta = rows.model._meta
    ordered = rows if rows.query.order_by else rows.order_by("pk")
    change = UpdateQuery(rows.model)
    change.add_update_values(values)
    try:
        chosen, chosen_parameters = ordered.values("pk").query.sql_with_params()
    except EmptyResultSet:
        return None
    update, parameters = change.sql_with_params()
    table, key = _quoted(meta.db_table), _quoted(meta.pk.column)
    lock = f"FOR UPDATE OF {table}{' SKIP LOCKED' if skip_locked else ''}"
    sql = f"{update} FROM ({chosen} {lock}) AS chosen WHERE {table}.{key} = chosen.pk RETURNING {table}"
    return sql, (*parameters, *chosen_parameters)


def _quoted(name: str) -> str:
    return connection.ops.quote_name(name)


def lock_until_end(*numbers: int) -> None:
    """Wait for this lock (a number, or a number and a key), and keep others waiting until the caller's transaction ends."""
    with connection.cursor() as cursor:
        cursor.execute(f"SELECT pg_advisory_xact_lock({_placeholders(numbers)})", numbers)


def try_lock_until_end(*numbers: int) -> bool:
    """As lock_until_end, without waiting: whether no other transaction had the lock."""
    with connection.cursor() as cursor:
        cursor.execute(f"SELECT pg_try_advisory_xact_lock({_placeholders(numbers)})", numbers)
        (is_ours,) = cursor.fetchone()
    return bool(is_ours)


def _placeholders(numbers: tuple[int, ...]) -> str:
    return ", ".join(["%s"] * len(numbers))
