"""The options of ./run. Needs only Python: they are checked before anything is installed."""

import argparse
import errno
import os
import socket
from pathlib import Path

EPILOG = """\
Without --detach, ./run stays in the foreground and stops all it started on Ctrl-C; the data stay.

environment:
  SPANWISE_VAR     the state folder, as --var
  DATABASE_URL     a PostGIS database to use instead of the private one
  REDIS_URL        a Redis to use instead of the private one
  SPANWISE_PYTHON  the Python (3.11 or newer) that .venv is made with, else the fastest
All settings: docs/operations.md

exit codes: 0 done, 1 could not start (or is running already), 2 wrong options, 3 packages are missing;
            --status: 0 ready, 1 running but not ready, 3 not running"""


def _data_file(text: str) -> Path:
    path = Path(text).resolve()
    if not path.is_file():
        raise argparse.ArgumentTypeError(f"no such file: {text}")
    if not os.access(path, os.R_OK):
        raise argparse.ArgumentTypeError(f"this user may not read {text}")
    return path


def _port(text: str) -> int:
    if not text.isascii() or not text.isdigit() or not 1 <= int(text) <= 65535:
        raise argparse.ArgumentTypeError(f"{text!r} is not a port (1 to 65535)")
    return int(text)


def parse(arguments: list[str], project: Path) -> argparse.Namespace:
    """Parse the command line of ./run. Exits on --help and on an error, as argparse does."""
    parser = argparse.ArgumentParser(
        prog="./run",
        description="Start Spanwise on this machine. Installs what is missing, and loads a demo region into an empty database.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument(
        "--osm",
        metavar="FILE",
        type=_data_file,
        action="append",
        default=[],
        help="own OpenStreetMap data instead of the demo region (repeatable)",
    )
    parser.add_argument(
        "--zones", metavar="FILE", type=_data_file, action="append", default=[], help="own no-fly zones, GeoJSON or ED-269 (repeatable)"
    )
    parser.add_argument("--port", metavar="N", type=_port, default=8000, help="port on 127.0.0.1 (default 8000)")
    parser.add_argument(
        "--var", metavar="DIR", type=Path, default=None, help="the state folder (default var/); two states can run side by side"
    )
    action = parser.add_mutually_exclusive_group()
    action.add_argument("--detach", action="store_true", help="return once it is ready; the last line is `ready http://127.0.0.1:PORT`")
    action.add_argument("--status", action="store_true", help="say what runs on this state")
    action.add_argument("--stop", action="store_true", help="stop what runs on this state")
    options = parser.parse_args(arguments)
    options.var = (options.var or Path(os.environ.get("SPANWISE_VAR") or project / "var")).resolve()
    try:
        (options.var / "instance.json").exists()
    except PermissionError:
        parser.error(f"this user may not enter {options.var}")
    return options


def port_problem(port: int) -> str | None:
    """Return why this port cannot be used, or None."""
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", port))
        except OSError as error:
            if error.errno == errno.EADDRINUSE:
                return f"port {port} is in use by another program; choose another one with --port"
            if error.errno == errno.EACCES:
                return f"this user may not use port {port}; choose one above 1023 with --port"
            raise
    return None
