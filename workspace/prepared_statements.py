"""Prepared statements for the small reads and writes of the busiest paths, parsed and planned once per connection.

Django's own cursor sends each statement as text, to be parsed and planned again, and first checks the connection. Here the statement
itself is the check: a dead connection is replaced, and the statement sent once more. Outside of transactions it is sent with libpq's own
call, which costs half as much as a cursor.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from hashlib import sha256
from typing import Any

import psycopg
from django.db import DEFAULT_DB_ALIAS, InterfaceError, OperationalError, connection, connections
from django.db.backends.base.base import BaseDatabaseWrapper
from psycopg import abc, pq
from psycopg.adapt import PyFormat, Transformer

from workspace.jobs.planning_lock import without_planning_lock


@dataclass(frozen=True, eq=False)
class _Prepared:
    """State of one connection: how its values are read and written, and the names of statements prepared on its server."""

    server: psycopg.Connection[Any]
    transformer: abc.Transformer
    known: set[bytes]


def prepared_rows(statement: str, parameters: Sequence[Any] = ()) -> list[tuple[Any, ...]]:
    """Return the rows of a statement that may be sent twice; `%s` are its parameters, cast in SQL where their type is not plain.

    Inside a transaction it is part of it. Raises what Django's own cursor raises.
    """
    try:
        return _rows(statement, parameters)
    except (OperationalError, InterfaceError):
        if connection.in_atomic_block or connection.is_usable():
            raise
        connection.close()
        return _rows(statement, parameters)


def _rows(statement: str, parameters: Sequence[Any]) -> list[tuple[Any, ...]]:
    own = connections[DEFAULT_DB_ALIAS]  # of this thread: each access through `connection` looks it up
    own.ensure_connection()
    server: psycopg.Connection[Any] = own.connection
    with own.wrap_database_errors:
        if server.autocommit and server.pgconn.transaction_status == pq.TransactionStatus.IDLE:
            return _rows_at_once(_prepared_of(own), statement, parameters)
        with psycopg.Cursor(server) as cursor:  # begins the transaction if needed
            cursor.execute(statement, parameters, prepare=True)
            return cursor.fetchall() if cursor.pgresult and cursor.pgresult.nfields else []


def _prepared_of(own: BaseDatabaseWrapper) -> _Prepared:
    held: _Prepared | None = getattr(own, _HELD, None)
    if held is None or held.server is not own.connection:
        held = _Prepared(own.connection, Transformer(own.connection), set())
        setattr(own, _HELD, held)
    return held


def _rows_at_once(prepared: _Prepared, statement: str, parameters: Sequence[Any]) -> list[tuple[Any, ...]]:
    server, transformer, known = prepared.server, prepared.transformer, prepared.known
    name = _name(statement)
    values = transformer.dump_sequence(parameters, [PyFormat.TEXT] * len(parameters))
    result = None
    if name in known:
        result = without_planning_lock(server.pgconn.exec_prepared, name, values)
        state = result.error_field(pq.DiagnosticField.SQLSTATE)
        if state == _TYPES_CHANGED:  # after a concurrent migration
            _checked(server.pgconn.exec_(b"DEALLOCATE " + name), server)
        if state in (_NOT_PREPARED, _TYPES_CHANGED):
            result = None
    if result is None:
        _checked(server.pgconn.prepare(name, _numbered(statement).encode()), server)
        known.add(name)
        result = without_planning_lock(server.pgconn.exec_prepared, name, values)
    transformer.set_pgresult(_checked(result, server))
    return transformer.load_rows(0, result.ntuples, tuple)


_HELD = "spanwise_prepared"  # attribute of Django's connection
_NOT_PREPARED = b"26000"  # invalid_sql_statement_name: the server forgot it, as after DEALLOCATE ALL
_TYPES_CHANGED = b"0A000"  # feature_not_supported: "cached plan must not change result type"


@lru_cache(maxsize=64)
def _name(statement: str) -> bytes:
    """Return the name of a statement: the same in every process, and unique to the statement."""
    return b"spanwise_" + sha256(statement.encode()).hexdigest()[:16].encode()


def _numbered(statement: str) -> str:
    """Return the statement with libpq's $1, $2 for each `%s`."""
    first, *rest = statement.split("%s")
    return first + "".join(f"${number}{text}" for number, text in enumerate(rest, start=1))


def _checked(result: pq.abc.PGresult, server: psycopg.Connection[Any]) -> pq.abc.PGresult:
    if result.status in (pq.ExecStatus.TUPLES_OK, pq.ExecStatus.COMMAND_OK):
        return result
    error = psycopg.errors.error_from_result(result)
    if server.pgconn.status == pq.ConnStatus.BAD:
        raise psycopg.OperationalError(str(error)) from error
    raise error
