"""Leases, by which a process holds a row until a time, and locks, by which one transaction at a time does something.

Rows of a killed process are soon free for others. A leasable row has `lease_expires_at` and `holder`: "name/run", where the name stays the
same at every start of a process. Times are the database's, so that machine clocks do not matter. A holder's writes to its row are
conditional on the holder, or, for a job, on the attempt: a process that lost its lease unnoticed changes nothing.
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

SURE_SHARE = 0.8  # of a lease: a margin for clock drift and writes under way
_Row = TypeVar("_Row", bound=Model)


@dataclass(frozen=True, kw_only=True)
class HolderOptions:
    """Identity of a holder. `name` is unique and the same at every start of a process; `run` and `holder` differ for each run."""

    name: str
    run: str = field(default_factory=lambda: secrets.token_hex(4))
    lease_s: float = 10.0  # rows of a killed process are taken over within this

    @property
    def holder(self) -> str:
        return f"{self.name}/{self.run}"


def holder_name(configured: str | None) -> str:
    """Return the configured name in the form of holders; without one, a name unique to this process on its machine."""
    return re.sub(r"[^\w.-]", "-", configured or f"{socket.gethostname()}-{os.getpid()}")[:80]


def held_until_s(asked_s: float, lease_s: float) -> float:
    """Return until when a lease requested at a time, and granted, is surely held; monotonic seconds."""
    return asked_s + SURE_SHARE * lease_s


def from_now(seconds: float) -> CombinedExpression:
    """Return an expression for a time by the database's clock."""
    return Now() + timedelta(seconds=seconds)


def has_run_out(lease_expires_at: datetime | None) -> bool:
    """Whether the lease of a row that was just read has run out."""
    return lease_expires_at is None or lease_expires_at < timezone.now()


def is_free() -> Q:
    """Return a condition for rows without a holder, or with an expired lease."""
    return Q(lease_expires_at=None) | Q(lease_expires_at__lt=Now())


def is_free_for(holder: str, *, lease_s: float, namesake_s: float | None = None) -> Q:
    """Return is_free, or rows of the same process before a restart: at once, or after `namesake_s` without renewal.

    With `namesake_s`, two processes that share a name by mistake do not take rows from each other.
    """
    namesake = Q(holder__startswith=f"{holder.rsplit('/', 1)[0]}/")
    if namesake_s is not None:
        namesake &= Q(lease_expires_at__lt=from_now(lease_s - namesake_s))
    return is_free() | Q(holder__in=["", holder]) | namesake


def take(rows: QuerySet[_Row], *, holder: str, lease_s: float, skip_locked: bool = False, **changes: Any) -> list[_Row]:
    """Lease these rows, which the caller has filtered to free ones, and return them as updated.

    Of two concurrent calls one gets a row. skip_locked: skip rows that other transactions are writing instead of waiting.
    """
    found = _update(rows, {"holder": holder, "lease_expires_at": from_now(lease_s), **changes}, skip_locked=skip_locked)
    return [] if found is None else list(rows.model._default_manager.raw(f"{found[0]}.*", found[1]))


def renew(held: QuerySet[Any], *, lease_s: float, column: str = "pk") -> dict[Any, Any]:
    """Extend the leases of rows; returns the value of a column for each row still held, by its key."""
    found = _update(held, {"lease_expires_at": from_now(lease_s)})
    if found is None:
        return {}
    key = held.model._meta.pk.column
    value = key if column == "pk" else held.model._meta.get_field(column).column
    with connection.cursor() as cursor:
        cursor.execute(f"{found[0]}.{_quoted(key)}, {_quoted(held.model._meta.db_table)}.{_quoted(value)}", found[1])
        return dict(cursor.fetchall())


def release(held: QuerySet[Any], *, after_s: float = 0.0, **changes: Any) -> int:
    """Free these rows for any holder, now or after some seconds. Returns how many there were."""
    return held.update(lease_expires_at=from_now(after_s) if after_s else None, **changes)


def _update(rows: QuerySet[Any], values: dict[str, Any], *, skip_locked: bool = False) -> tuple[str, tuple[Any, ...]] | None:
    """Return an update up to the table's name after RETURNING, and its parameters; None where no row can match.

    It is one statement and needs no transaction; rows are locked in the order of the queryset, or of their keys, so that processes cannot
    deadlock.
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
    # Materialized: within a nested loop a subquery would run again for each row, and choose more rows than its limit.
    sql = f"WITH chosen AS MATERIALIZED ({chosen} {lock}) {update} FROM chosen WHERE {table}.{key} = chosen.pk RETURNING {table}"
    return sql, (*chosen_parameters, *parameters)


def _quoted(name: str) -> str:
    return connection.ops.quote_name(name)


def lock_until_end(*numbers: int) -> None:
    """Wait for this lock (a number, or a number and a key), and hold it until the caller's transaction ends."""
    with connection.cursor() as cursor:
        cursor.execute(f"SELECT pg_advisory_xact_lock({_placeholders(numbers)})", numbers)


def try_lock_until_end(*numbers: int) -> bool:
    """Try lock_until_end without waiting; returns False if another transaction has the lock."""
    with connection.cursor() as cursor:
        cursor.execute(f"SELECT pg_try_advisory_xact_lock({_placeholders(numbers)})", numbers)
        (is_ours,) = cursor.fetchone()
    return bool(is_ours)


def _placeholders(numbers: tuple[int, ...]) -> str:
    return ", ".join(["%s"] * len(numbers))
