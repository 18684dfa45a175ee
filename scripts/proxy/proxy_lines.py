"""nginx with JSON logs: python -m scripts.proxy.proxy_lines nginx ARGUMENT...

nginx itself writes requests as JSON (scripts/proxy/proxy.py), but never errors. Signals are passed on to it. No line contains the query
of an address, which may hold secrets.
"""

import re
import signal
import subprocess
import sys
import threading
from collections.abc import Iterable
from types import FrameType

from operation.json_lines import is_asked_for, is_json, json_line

FAULT = re.compile(r"\d{4}/\d\d/\d\d \d\d:\d\d:\d\d \[(?P<level>[a-z]+)\] (?P<message>.*)", re.DOTALL)
QUERY = re.compile(r"\?[^\s\"]+")
LEVELS = {"debug": "DEBUG", "info": "INFO", "notice": "INFO", "warn": "WARNING", "error": "ERROR"}  # all others are worse
PASSED_ON = (signal.SIGTERM, signal.SIGINT, signal.SIGQUIT, signal.SIGHUP)


def reported(line: str) -> str:
    """Return a line of nginx as it is to be logged."""
    if is_json(line):
        return line
    line = QUERY.sub("?...", line)
    if not is_asked_for():
        return line
    found = FAULT.fullmatch(line)
    if found is None:
        return json_line(line, logger="nginx")
    return json_line(found["message"], level=LEVELS.get(found["level"], "CRITICAL"), logger="nginx")


def start(command: list[str]) -> subprocess.Popen[str]:
    """Start nginx, and a thread that logs its errors."""
    nginx = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, errors="replace")
    threading.Thread(target=_write_down, args=[nginx.stderr or ()], name="lines of nginx", daemon=True).start()
    return nginx


def _write_down(lines: Iterable[str]) -> None:
    for line in lines:
        sys.stderr.write(reported(line.rstrip("\n")) + "\n")
        sys.stderr.flush()


def main(command: list[str]) -> int:
    nginx = start(command)

    def pass_on(number: int, frame: FrameType | None) -> None:
        nginx.send_signal(number)

    for number in PASSED_ON:
        signal.signal(number, pass_on)
    return nginx.wait()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
