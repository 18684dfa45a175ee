"""What every program does first: it tells how it does, and is traced, where that is asked for."""

from operation.exposition import tell_how_it_does
from operation.readiness import Check
from operation.tracing import begin_tracing


def program_begins(program: str, *checks: Check) -> None:
    """`checks` are what it needs to work, else database and Redis."""
    begin_tracing(program)
    tell_how_it_does(program, *checks)
