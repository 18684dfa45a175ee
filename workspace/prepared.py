"""Small reads and writes of the busiest paths: statements that the server has parsed and planned once per connection.

Django's own cursor sends each statement as text, to be parsed and planned again, and looks first whether the connection still lives.
Here the statement itself is that look: a connection that turns out to be dead is replaced, and the statement sent once more.
"""

from collections.abc import Sequence
from typing import Any

import psycopg
from django.db import InterfaceError, OperationalError, connection


def prepared_rows(statement: str, parameters: Sequence[Any] = ()) -> list[tuple[Any, ...]]:
    """The rows of a statement that may be sent twice; `%s` are its parameters, cast in SQL where their type is not plain.

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
    connection.ensure_connection()
    with connection.wrap_database_errors, psycopg.Cursor(connection.connection) as cursor:
        cursor.execute(statement, parameters, prepare=True)
        return cursor.fetchall() if cursor.pgresult and cursor.pgresult.nfields else []
