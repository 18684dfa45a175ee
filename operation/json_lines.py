"""JSON for every line that a program writes: python -m operation.json_lines MODULE [ARGUMENT...]

Also holds the formatters of logging. Run as a program it converts all other lines to JSON: prints, warnings and uncaught exceptions, also
before logging is set up, and in forked processes. The module may be a file that ends in .py.
"""

import io
import json
import logging
import os
import runpy
import sys
import threading
import warnings
from datetime import UTC, datetime
from types import TracebackType
from typing import Any, TextIO

from operation.log_context import ABOUT_REQUEST, FIELDS, facts
from operation.redaction import without_secrets

IN_ONE_LINE = {code: f"\\x{code:02x}" for code in (*range(32), 127, 0x85, 0x2028, 0x2029)} | {9: "\\t", 10: "\\n", 13: "\\r"}
MAX_LINE_LENGTH = 100_000  # characters; an endless line is cut


class LineFormatter(logging.Formatter):
    """`2026-01-31 12:00:00,000 INFO name message [request=… mission=…]`. Line breaks in a message are escaped."""

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
    """One object per line: time (RFC 3339, UTC), level, logger, message, and the context of the work."""

    def __init__(self, program: str = "", **_: object) -> None:
        super().__init__()
        self._program = program or os.environ.get("SPANWISE_PROGRAM", "")

    def format(self, record: logging.LogRecord) -> str:
        reported: dict[str, Any] = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds"),
            "level": record.levelname,
            "logger": record.name,
            "message": without_secrets(record.getMessage()),
        }
        if self._program:
            reported["program"] = self._program
        reported |= named_in(record)
        if record.exc_info:
            reported["exception"] = without_secrets(self.formatException(record.exc_info))
        if record.stack_info:
            reported["stack"] = without_secrets(record.stack_info)
        return json.dumps(reported, default=str)  # in ASCII: some programs treat other characters as line ends


def named_in(record: logging.LogRecord) -> dict[str, str]:
    """Return the context of a line: its own `extra` before the current context.

    Django logs some lines after a request, and passes the request object in them.
    """
    reported = {name: getattr(record, name, None) for name in FIELDS}
    read = getattr(reported.pop("request"), ABOUT_REQUEST, None)
    named = {**(read() if callable(read) else {}), **facts(), **{name: value for name, value in reported.items() if value is not None}}
    return {name: str(named[name]) for name in FIELDS if named.get(name) not in (None, "")}


def is_asked_for() -> bool:
    return os.environ.get("SPANWISE_LOG_FORMAT") == "json"


def json_line(message: str, *, level: str = "INFO", logger: str = "output") -> str:
    reported = {"time": datetime.now(UTC).isoformat(timespec="milliseconds"), "level": level, "logger": logger}
    reported["message"] = without_secrets(message)
    if program := os.environ.get("SPANWISE_PROGRAM"):
        reported["program"] = program
    return json.dumps(reported)


def is_json(line: str) -> bool:
    """Whether the line is already a JSON object."""
    if not line.startswith("{"):
        return False
    try:
        json.loads(line)
    except ValueError:
        return False
    return True


class JsonLines(io.TextIOBase):
    """Replaces a stream. It writes whole lines at once, so that those of several processes do not mix."""

    def __init__(self, stream: TextIO, name: str) -> None:
        self._stream, self._name = stream, name
        self._forget()
        os.register_at_fork(after_in_child=self._forget)

    def _forget(self) -> None:
        """Drop a line that the parent process began."""
        self._begun, self._lock = "", threading.RLock()

    @property
    def encoding(self) -> str:  # type: ignore[override]
        return "utf-8"

    def writable(self) -> bool:
        return True

    def fileno(self) -> int:
        return self._stream.fileno()

    def isatty(self) -> bool:
        return False

    def write(self, text: str) -> int:
        with self._lock:
            *lines, self._begun = (self._begun + text).split("\n")
            if len(self._begun) > MAX_LINE_LENGTH:
                lines, self._begun = [*lines, self._begun], ""
            if reported := "".join(self._line(line) + "\n" for line in lines if line.strip()):
                self._stream.write(reported)
                self._stream.flush()
        return len(text)

    def flush(self) -> None:
        self._stream.flush()

    def close(self) -> None:
        """Write an unfinished line at the end of the program."""
        if self._begun:
            self.write("\n")

    def _line(self, line: str) -> str:
        return line if is_json(line) else json_line(line.rstrip(), logger=self._name)


def write_json_lines() -> None:
    """Write JSON from here on, in this process and its forks."""
    sys.stdout = sys.__stdout__ = JsonLines(sys.stdout, "stdout")  # type: ignore[assignment,misc]
    sys.stderr = sys.__stderr__ = JsonLines(sys.stderr, "stderr")  # type: ignore[assignment,misc]
    sys.excepthook = _log_uncaught
    threading.excepthook = lambda reported: _log_uncaught(reported.exc_type, reported.exc_value, reported.exc_traceback)
    warnings.showwarning = _log_warning


def _notify(level: int, message: str, error: Any = None) -> None:
    record = logging.LogRecord("python", level, "", 0, message, None, error)
    sys.stderr.write(JsonFormatter(os.environ.get("SPANWISE_PROGRAM", "")).format(record) + "\n")


def _log_uncaught(kind: type[BaseException], error: BaseException | None, trace: TracebackType | None) -> None:
    if not issubclass(kind, SystemExit | KeyboardInterrupt):
        _notify(logging.CRITICAL, f"{kind.__name__} was not caught", (kind, error, trace))


def _log_warning(message: Any, category: type[Warning], filename: str, lineno: int, file: Any = None, line: Any = None) -> None:
    _notify(logging.WARNING, f"{category.__name__}: {message} ({filename}:{lineno})")


def main() -> None:
    _, target, *arguments = sys.argv
    write_json_lines()
    sys.argv = [target, *arguments]
    if target.endswith(".py"):
        sys.path[0] = os.path.dirname(os.path.abspath(target))  # noqa: PTH100, PTH120 - as Python itself has it
        runpy.run_path(target, run_name="__main__")
    else:
        runpy.run_module(target, run_name="__main__", alter_sys=True)


if __name__ == "__main__":
    main()
