"""Start-up of every program: metrics, optional tracing, and memory management."""

from operation.exposition import serve_health
from operation.garbage_collection import freeze_startup_objects, trim_memory_periodically
from operation.readiness import Check
from operation.tracing import begin_tracing


def program_begins(program: str, *checks: Check) -> None:
    """Start them. `checks` are what the program needs, by default database and Redis."""
    begin_tracing(program)
    serve_health(program, *checks)
    freeze_startup_objects()
    trim_memory_periodically()
