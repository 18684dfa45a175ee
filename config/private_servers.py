"""Locations of this checkout's private PostgreSQL and Redis."""

import hashlib
import os
import tempfile
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

PROJECT_DIR = Path(__file__).resolve().parent.parent
DATABASE_NAME = "spanwise"
DATABASE_ROLE = "spanwise"


def state_directory() -> Path:
    """Return the folder that holds all state of this installation: SPANWISE_VAR, else var/ in the checkout."""
    return Path(os.environ.get("SPANWISE_VAR") or PROJECT_DIR / "var").resolve()


def socket_directory(state: Path) -> Path:
    """Return the short folder of this state's unix sockets (their paths may have 107 bytes at most).

    A folder that `./run` has stored in the state takes precedence, so that every shell finds the same one whatever its TMPDIR is.
    """
    note = state / "socket_directory"
    if note.exists():
        return Path(note.read_text().strip())
    digest = hashlib.sha256(str(state).encode()).hexdigest()[:10]
    return Path(tempfile.gettempdir()) / f"spanwise-{digest}"


def private_database_url(state: Path) -> str:
    sockets = str(socket_directory(state)).replace("/", "%2F")
    return f"postgis://{DATABASE_ROLE}@{sockets}/{DATABASE_NAME}"


def private_redis_url(state: Path) -> str:
    return f"unix://{socket_directory(state)}/redis.sock"


def broker_url(redis_url: str) -> str:
    """Return the URL of the same Redis and database, in Celery's form."""
    if not redis_url.startswith("unix://"):
        return redis_url
    parts = urlsplit(redis_url)
    database = parse_qs(parts.query).get("db", ["0"])[0]
    return f"redis+socket://{parts.netloc}{parts.path}?virtual_host={database}"
