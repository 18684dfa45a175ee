"""What must outlive a crash, in one SQLite file: what was not told yet, what was given, and how far the counters are."""

import json
import math
import secrets
import sqlite3
from collections.abc import Sequence
from pathlib import Path
from typing import Any

TABLES = """
CREATE TABLE IF NOT EXISTS facts (name TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS records (sequence INTEGER PRIMARY KEY AUTOINCREMENT, body TEXT NOT NULL, refused TEXT);
CREATE TABLE IF NOT EXISTS results (sequence INTEGER PRIMARY KEY AUTOINCREMENT, body TEXT NOT NULL, refused TEXT);
CREATE TABLE IF NOT EXISTS captures (sequence INTEGER PRIMARY KEY AUTOINCREMENT, body TEXT NOT NULL, refused TEXT);
CREATE TABLE IF NOT EXISTS flights (number INTEGER PRIMARY KEY AUTOINCREMENT, body TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS acknowledgements (number INTEGER PRIMARY KEY AUTOINCREMENT, body TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS commands (id TEXT PRIMARY KEY, body TEXT NOT NULL, state TEXT NOT NULL);
"""
OPEN, UNDER_WAY, DONE = "open", "under way", "done"
COUNTED = ("records", "results", "captures")  # tables whose numbers the server knows


class Journal:
    """Numbers grow for as long as the file lives, also over crashes; a new file is a new stream."""

    def __init__(self, path: Path | str) -> None:
        self._database = sqlite3.connect(path, isolation_level=None)
        self._database.execute("PRAGMA journal_mode = WAL")
        self._database.execute("PRAGMA synchronous = FULL")
        self._database.executescript(TABLES)
        self._database.execute("INSERT OR IGNORE INTO facts VALUES ('stream', ?)", [secrets.token_hex(16)])

    @property
    def stream(self) -> str:
        return str(self.fact("stream"))

    def close(self) -> None:
        self._database.close()

    # --- what is to be told ---

    def add_record(self, record: dict[str, Any]) -> int:
        return self._add("records", record)

    def add_result(self, result: dict[str, Any]) -> int:
        return self._add("results", result)

    def add_capture(self, capture: dict[str, Any]) -> int:
        return self._add("captures", capture)

    def add_flight(self, flight: dict[str, Any]) -> int:
        return self._add("flights", flight)

    def waiting(self, table: str, most: int) -> list[tuple[int, dict[str, Any]]]:
        """The oldest first, each with its number."""
        own = "sequence" if table in COUNTED else "number"
        refused = "WHERE refused IS NULL" if table in COUNTED else ""
        rows = self._database.execute(f"SELECT {own}, body FROM {table} {refused} ORDER BY {own} LIMIT ?", [most])  # noqa: S608
        return [(number, json.loads(body)) for number, body in rows]

    def reported(self, table: str, numbers: Sequence[int]) -> None:
        """The server has these."""
        own = "sequence" if table in COUNTED else "number"
        with self._database:
            self._database.execute("BEGIN")
            self._database.executemany(f"DELETE FROM {table} WHERE {own} = ?", [[number] for number in numbers])  # noqa: S608

    def refuse(self, table: str, faults: dict[int, Any]) -> None:
        """The server will never take these: kept with the reason, for somebody to look at, and not sent again."""
        rows = [[json.dumps(fault), number] for number, fault in faults.items()]
        with self._database:
            self._database.execute("BEGIN")
            self._database.executemany(f"UPDATE {table} SET refused = ? WHERE sequence = ?", rows)  # noqa: S608

    def refused(self, table: str) -> list[tuple[int, Any]]:
        rows = self._database.execute(f"SELECT sequence, refused FROM {table} WHERE refused IS NOT NULL ORDER BY 1")  # noqa: S608
        return [(number, json.loads(fault)) for number, fault in rows]

    def added(self, table: str) -> int:
        """How many there ever were."""
        row = self._database.execute("SELECT seq FROM sqlite_sequence WHERE name = ?", [table]).fetchone()
        return int(row[0]) if row else 0

    # --- what was given ---

    def take(self, given: Any, etag: str) -> None:
        """What the server gave, and which of its commands are new: together, or a crash would forget one of both.

        A command that it gives no longer has been overtaken or is not wanted any more.
        """
        commands = (given or {}).get("commands", [])
        known = [command["id"] for command in commands]
        with self._database:
            self._database.execute("BEGIN")
            self._put("given", json.dumps(given))
            self._put("etag", etag)
            self._database.execute(
                "UPDATE commands SET state = ? WHERE id NOT IN (SELECT value FROM json_each(?))", [DONE, json.dumps(known)]
            )
            for command in commands:
                self._database.execute(
                    "INSERT OR IGNORE INTO commands (id, body, state) VALUES (?, ?, ?)", [command["id"], json.dumps(command), OPEN]
                )

    @property
    def given(self) -> Any:
        return self.kept("given")

    @property
    def etag(self) -> str | None:
        return self.fact("etag")

    def commands(self) -> list[tuple[dict[str, Any], str]]:
        """Those that are not done, the most urgent first."""
        rows = self._database.execute("SELECT body, state FROM commands WHERE state <> ?", [DONE])
        return sorted(((json.loads(body), state) for body, state in rows), key=lambda one: (one[0]["priority"], one[0]["sequence"]))

    def move_command(self, key: str, state: str, acknowledgement: dict[str, Any] | None = None) -> None:
        """With what is to be told of it."""
        with self._database:
            self._database.execute("BEGIN")
            self._database.execute("UPDATE commands SET state = ? WHERE id = ?", [state, key])
            if acknowledgement is not None:
                self._database.execute("INSERT INTO acknowledgements (body) VALUES (?)", [json.dumps(acknowledgement)])

    def keep(self, name: str, value: Any) -> None:
        self._put(name, json.dumps(value))

    def kept(self, name: str) -> Any:
        return json.loads(self.fact(name) or "null")

    def fact(self, name: str) -> str | None:
        row = self._database.execute("SELECT value FROM facts WHERE name = ?", [name]).fetchone()
        return None if row is None else str(row[0])

    def _put(self, name: str, value: str) -> None:
        self._database.execute("INSERT INTO facts VALUES (?, ?) ON CONFLICT (name) DO UPDATE SET value = excluded.value", [name, value])

    def _add(self, table: str, body: dict[str, Any]) -> int:
        cursor = self._database.execute(f"INSERT INTO {table} (body) VALUES (?)", [json.dumps(_reported(body), allow_nan=False)])  # noqa: S608
        return int(cursor.lastrowid or 0)


def _reported(body: dict[str, Any]) -> dict[str, Any]:
    """What is no number is not known: JSON has no word for it."""
    return {name: None if isinstance(value, float) and not math.isfinite(value) else value for name, value in body.items()}
