"""How a line of log looks: for people, or as JSON for programs. Both name what the work is about, and leave secrets out."""

import json
import logging
import os
from datetime import UTC, datetime
from typing import Any

from operation.log_context import ABOUT_REQUEST, FIELDS, facts
from operation.redaction import without_secrets

IN_ONE_LINE = {code: f"\\x{code:02x}" for code in (*range(32), 127, 0x85, 0x2028, 0x2029)} | {9: "\\t", 10: "\\n", 13: "\\r"}


class LineFormatter(logging.Formatter):
    """`2026-01-31 12:00:00,000 INFO name message [request=… mission=…]`. Whatever the message holds, it begins no line of its own."""

    def __init__(self) -> None:
        super().__init__("{asctime} {levelname} {name} {message}", style="{")

    def format(self, record: logging.LogRecord) -> str:
        return without_secrets(super().format(record))

    def formatMessage(self, record: logging.LogRecord) -> str:  # noqa: N802 (as logging has it)
        record.message = record.message.translate(IN_ONE_LINE)
        line = super().formatMessage(record)
        named = " ".join(f"{name}={value}" for name, value in named_in(record).items())
        return f"{line} [{named}]" if named else line


class JsonFormatter(logging.Formatter):
    """One object a line: time (RFC 3339, UTC), level, logger, message, and what the work is about."""

    def __init__(self, program: str = "", **_: object) -> None:
        super().__init__()
        self._program = program or os.environ.get("SPANWISE_PROGRAM", "")

    def format(self, record: logging.LogRecord) -> str:
        told: dict[str, Any] = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds"),
            "level": record.levelname,
            "logger": record.name,
            "message": without_secrets(record.getMessage()),
        }
        if self._program:
            told["program"] = self._program
        told |= named_in(record)
        if record.exc_info:
            told["exception"] = without_secrets(self.formatException(record.exc_info))
        if record.stack_info:
            told["stack"] = without_secrets(record.stack_info)
        return json.dumps(told, default=str)  # in ASCII: some programs take other signs for the end of a line


def named_in(record: logging.LogRecord) -> dict[str, str]:
    """What the line itself says in `extra`, before what is known of the work at hand. Django writes some lines once a request is over, and
    names the request object in them.
    """
    told = {name: getattr(record, name, None) for name in FIELDS}
    read = getattr(told.pop("request"), ABOUT_REQUEST, None)
    named = {**(read() if callable(read) else {}), **facts(), **{name: value for name, value in told.items() if value is not None}}
    return {name: str(named[name]) for name in FIELDS if named.get(name) not in (None, "")}
