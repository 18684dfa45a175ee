"""What every program does once it has begun: it tells how it does, is traced where that is asked for, and minds its memory."""

from operation.exposition import serve_health
from operation.garbage_collection import freeze_startup_objects, trim_memory_periodically
from operation.readiness import Check
from operation.tracing import begin_tracing


def program_begins(program: str, *checks: Check) -> None:
    """`checks` are what it needs to work, else database and Redis."""
    begin_tracing(program)
    serve_health(program, *checks)
    freeze_startup_objects()
    trim_memory_periodically()
