"""Statements that are prepared once per connection: in and outside of transactions, on connections that died or forgot."""

from collections.abc import Iterator
from datetime import UTC, datetime

import psycopg
import pytest
from django.db import DataError, OperationalError, ProgrammingError, connection, transaction

from workspace.models import Organisation
from workspace.prepared_statements import prepared_rows

pytestmark = pytest.mark.django_db(transaction=True)
BACKEND = "SELECT pg_backend_pid()"


@pytest.fixture
def another() -> Iterator[psycopg.Connection]:
    with psycopg.connect(**connection.get_connection_params() | {"cursor_factory": psycopg.Cursor}, autocommit=True) as server:
        yield server


def test_values_come_as_django_reads_them() -> None:
    at = datetime(2026, 11, 21, 12, 30, 15, 250, tzinfo=UTC)
    rows = prepared_rows("SELECT key, %s::timestamptz, %s::float8, NULL, true FROM unnest(%s::bigint[]) AS key", [at, 0.1, [7, 9]])
    assert rows == [(7, at, 0.1, None, True), (9, at, 0.1, None, True)]


def test_text_with_quotes_is_a_value_and_nothing_else() -> None:
    text = "'; DROP TABLE workspace_job; -- $1 %s"
    assert prepared_rows("SELECT %s::text", [text]) == [(text,)]


def test_a_write_tells_no_rows_and_is_done() -> None:
    assert prepared_rows("INSERT INTO workspace_organisation (name) VALUES (%s)", ["Prepared"]) == []
    assert Organisation.objects.filter(name="Prepared").exists()


def test_inside_a_transaction_it_is_part_of_it() -> None:
    with pytest.raises(ZeroDivisionError), transaction.atomic():
        prepared_rows("INSERT INTO workspace_organisation (name) VALUES (%s)", ["Taken back"])
        assert Organisation.objects.filter(name="Taken back").exists()
        1 / 0  # noqa: B018
    assert not Organisation.objects.filter(name="Taken back").exists()


def test_a_killed_connection_is_replaced_and_the_statement_sent_once_more(another: psycopg.Connection) -> None:
    ((before,),) = prepared_rows(BACKEND)
    another.execute("SELECT pg_terminate_backend(%s, 5000)", [before])
    ((after,),) = prepared_rows(BACKEND)
    assert after != before


def test_in_a_transaction_a_killed_connection_is_an_error(another: psycopg.Connection) -> None:
    with pytest.raises(OperationalError), transaction.atomic():
        ((backend,),) = prepared_rows(BACKEND)
        another.execute("SELECT pg_terminate_backend(%s, 5000)", [backend])
        prepared_rows(BACKEND)
    connection.close()  # or the next test would find it dead


def test_a_server_that_forgot_its_statements_is_told_them_again() -> None:
    before = prepared_rows(BACKEND)
    with connection.cursor() as cursor:
        cursor.execute("DEALLOCATE ALL")
    assert prepared_rows(BACKEND) == before


def test_a_statement_whose_types_have_changed_is_prepared_anew() -> None:
    with connection.cursor() as cursor:
        cursor.execute("CREATE TABLE changing (value integer)")
        cursor.execute("INSERT INTO changing VALUES (7)")
    try:
        assert prepared_rows("SELECT value FROM changing") == [(7,)]
        with connection.cursor() as cursor:
            cursor.execute("ALTER TABLE changing ALTER value TYPE text")
        assert prepared_rows("SELECT value FROM changing") == [("7",)]
    finally:
        with connection.cursor() as cursor:
            cursor.execute("DROP TABLE changing")


@pytest.mark.parametrize(
    ("statement", "parameters", "error"),
    [("SELECT nothing FROM nowhere", [], ProgrammingError), ("SELECT %s::bigint", ["seven"], DataError)],
)
def test_faults_are_those_of_djangos_own_cursor_and_leave_the_connection_whole(
    statement: str, parameters: list[object], error: type[Exception]
) -> None:
    for _ in range(2):
        with pytest.raises(error):
            prepared_rows(statement, parameters)
    assert prepared_rows("SELECT 1") == [(1,)]
