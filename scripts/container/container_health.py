"""Whether the program of this container works; the container engine runs it every few seconds."""

import os
import sys
import urllib.error
import urllib.request
from pathlib import Path

from scripts.proxy.proxy_site import ALIVE

FIRST_PROCESS = Path("/proc/1/cmdline")
TIMEOUT_S = 5.0


def program(command_line: bytes) -> str:
    """Return the program's name from the command line of the container's first process: an init, the entry point and the name."""
    words = [word.decode(errors="replace") for word in command_line.split(b"\0")]
    names = words[words.index("spanwise") + 1 :] if "spanwise" in words else words
    return next((word for word in names if word and not word.startswith("-")), "web")


def address(name: str) -> str:
    """Return the address of the health check. It does not query the database: an unavailable database must not end programs."""
    if name == "proxy":
        return f"http://127.0.0.1:{os.environ.get('SPANWISE_PROXY_PORT', '8080')}{ALIVE}"
    port = os.environ.get("SPANWISE_METRICS", ":9464").rpartition(":")[2]
    return f"http://127.0.0.1:{port}/healthz"


def main() -> int:
    asked = address(program(FIRST_PROCESS.read_bytes()))
    try:
        urllib.request.urlopen(asked, timeout=TIMEOUT_S).close()  # noqa: S310 - this container itself
    except OSError as error:
        print(f"{asked}: {error}", file=sys.stderr)
        return 1
    return 0
