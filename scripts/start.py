"""Start, follow, show and stop one installation: the part of ./run that needs .venv.

python -m scripts.start [OPTION]...      (the options of ./run; SPANWISE_VAR names the state)
"""

import argparse
import fcntl
import json
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterable
from pathlib import Path
from types import FrameType
from typing import Any, NoReturn

from config.private_servers import socket_directory
from scripts.installation import database_cluster
from scripts.options import parse, port_problem
from scripts.places import DEMO_USER, PROJECT_DIR, WEB_PROGRAMS, CannotStart, Places, prepare_sockets, prepare_state, remove_sockets
from scripts.proxy import proxy
from scripts.supervision.programs import Program, database_server, queue_server, web_programs
from scripts.supervision.supervision import ProgramState, Supervisor

READY_TIMEOUT_S = 120.0
EXIT_NOT_RUNNING = 3
FIRST_PROGRAMS = (*WEB_PROGRAMS, "proxy")
LINK_PROGRAMS = ("live", "uav-link")  # for pages and UAVs


def address(port: int) -> str:
    return f"http://127.0.0.1:{port}"


def _instance(places: Places) -> dict[str, Any]:
    """Return what was last started on this state; empty when nothing was, or it has been stopped."""
    try:
        content: dict[str, Any] = json.loads(places.instance.read_text())
    except (OSError, ValueError):
        return {}
    return content


def _note_instance(places: Places, *, port: int, is_serving: bool) -> None:
    draft = places.instance.with_suffix(".new")
    draft.write_text(json.dumps({"port": port, "is_serving": is_serving}))
    draft.replace(places.instance)


def reasons_not_ready(port: int) -> list[str]:
    """Return what is missing; empty when the program reports that it is ready."""
    host = next(
        (name.lstrip(".") for name in os.environ.get("SPANWISE_ALLOWED_HOSTS", "").split(",") if name.strip("* ")), f"127.0.0.1:{port}"
    )
    request = urllib.request.Request(f"{address(port)}/readyz", headers={"Host": host, "X-Forwarded-Proto": "https"})  # noqa: S310
    try:
        with urllib.request.urlopen(request, timeout=10) as response:  # noqa: S310 - our own http address
            return [str(missing) for missing in json.loads(response.read()).get("missing", [])]
    except urllib.error.HTTPError as error:
        try:
            return [str(reason) for reason in json.loads(error.read())["reasons"]]
        except (ValueError, KeyError, TypeError):
            return [f"/readyz answers {error.code}"]
    except OSError as error:
        return [f"no answer: {error}"]


def _is_listening(path: Path) -> bool:
    with socket.socket(socket.AF_UNIX) as connection:
        return connection.connect_ex(str(path)) == 0


class Installation:
    """One state with its servers and programs."""

    def __init__(self, options: argparse.Namespace) -> None:
        self.options = options
        self.places = Places(options.var)
        self.makes_demo_user = False

    # --- starting ----------------------------------------------------------------------------------------------------------------

    def start(self) -> int:
        self.places = prepare_state(self.options.var)
        with self.places.lock.open("w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                return self._refuse_second()
            self.sockets = prepare_sockets(self.options.var)
            self.supervisor = Supervisor(self.places, self.sockets)
            if self.supervisor.is_running():
                if _instance(self.places).get("is_serving"):
                    return self._refuse_second()
                self.supervisor.stop()  # left by an interrupted start
            return self._start_and_follow()

    def _refuse_second(self) -> int:
        port = _instance(self.places).get("port")
        where = f" at {address(port)}" if port else ""
        print(
            f"Spanwise is running on {self.places.state} already{where}. End it with ./run --stop, or choose another folder with --var.",
            file=sys.stderr,
        )
        return 1

    def _start_and_follow(self) -> int:
        try:
            self._start_servers()
            self._prepare()
            self._start_programs()
            _note_instance(self.places, port=self.options.port, is_serving=True)
            self._greet()
            if self.options.detach:
                print(f"ready {address(self.options.port)}", flush=True)
                return 0
        except KeyboardInterrupt:
            self._stop_quietly()
            return 130
        except BaseException:
            self._stop_quietly()
            raise
        return self._follow()

    def _stop_quietly(self) -> None:
        """Stop all programs, and ignore a second Ctrl-C, which would leave some of them running."""
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, signal.SIG_IGN)
        print("\nStopping … ", end="", flush=True)
        began = time.monotonic()
        self.supervisor.stop()
        self.places.instance.unlink(missing_ok=True)
        remove_sockets(self.places.state)
        print(f"{time.monotonic() - began:.1f} s. The data stay.", flush=True)

    def _start_servers(self) -> None:
        self.supervisor.end_leftovers()
        if problem := port_problem(self.options.port):
            raise CannotStart(problem)
        _note_instance(self.places, port=self.options.port, is_serving=False)
        began = time.monotonic()
        servers: list[Program] = []
        if not os.environ.get("DATABASE_URL"):
            database_cluster.prepare_cluster(self.places)
            servers.append(database_server(self.places, self.sockets))
        if not os.environ.get("REDIS_URL"):
            servers.append(queue_server(self.places, self.sockets))
        programs = web_programs(self.places, self.sockets)
        self.program_names = [program.name for program in programs]
        (self.places.generated / "nginx.conf").write_text(proxy.configuration(self.places, self.sockets, self.options.port))
        self.supervisor.start([*servers, *programs])
        if not os.environ.get("DATABASE_URL"):
            database_cluster.wait_for_database(self.sockets)
            if not database_cluster.database_exists(self.sockets):
                self.places.first_load.write_text(json.dumps({"demo_user": True}))
                database_cluster.create_database(self.sockets)
        if not os.environ.get("REDIS_URL"):
            database_cluster.wait_for_queue(self.sockets)
        if servers:
            print(f"{' and '.join(server.name for server in servers)} … {time.monotonic() - began:.1f} s", flush=True)

        self.makes_demo_user = self.places.first_load.exists() and json.loads(self.places.first_load.read_text())["demo_user"]

    def _prepare(self) -> None:
        command = [sys.executable, "-m", "scripts.prepare"]
        for path in self.options.osm:
            command += ["--osm", str(path)]
        for path in self.options.zones:
            command += ["--zones", str(path)]
        if subprocess.run(command, check=False).returncode != 0:
            raise CannotStart("the data could not be prepared; the reason is above")

    def _start_programs(self) -> None:
        """Start web program and proxy, then what pages and UAVs connect to, then the rest: starting all at once slows each."""
        began = time.monotonic()
        print("Programs … ", end="", flush=True)
        self.supervisor.start_programs(FIRST_PROGRAMS)
        self._wait_until_none(lambda: self._not_listening(WEB_PROGRAMS) or reasons_not_ready(self.options.port))
        self.supervisor.start_programs(LINK_PROGRAMS)
        self._wait_until_none(lambda: self._not_listening(LINK_PROGRAMS))
        self.supervisor.start_programs(name for name in self.program_names if name not in (*FIRST_PROGRAMS, *LINK_PROGRAMS))
        print(f"{time.monotonic() - began:.1f} s", flush=True)

    def _wait_until_none(self, reasons_of: Callable[[], list[str]]) -> None:
        """Wait until nothing is missing any more. Raises CannotStart with what still is."""
        until = time.monotonic() + READY_TIMEOUT_S
        while reasons := reasons_of():
            if time.monotonic() > until:
                print("failed", flush=True)
                raise CannotStart(f"not ready after {READY_TIMEOUT_S:.0f} s: {'; '.join(reasons)}. The logs are in {self.places.logs}")
            time.sleep(0.05)

    def _not_listening(self, names: Iterable[str]) -> list[str]:
        """Return the programs that do not listen yet, which they do once their application is loaded."""
        return [f"{name} has not started" for name in names if not _is_listening(self.sockets / f"{name}.sock")]

    def _greet(self) -> None:
        print(f"\nSpanwise is at {address(self.options.port)}", flush=True)
        password_file = self.places.demo_password
        if os.environ.get("DATABASE_URL"):
            print("Accounts are those of DATABASE_URL; the first one is made by manage.py createsuperuser", flush=True)
        elif self.makes_demo_user and password_file.exists():
            print(f"Sign in as {DEMO_USER} with the password {password_file.read_text().strip()}", flush=True)
        elif password_file.exists():
            print(f"Sign in as {DEMO_USER}; its first password is in {password_file}", flush=True)

    # --- running -----------------------------------------------------------------------------------------------------------------

    def _follow(self) -> int:
        """Stay until Ctrl-C, and report restarts of programs."""
        print("Ctrl-C stops it.", flush=True)
        starts = {state.name: state.started_at_s for state in self.supervisor.states()}
        try:
            while True:
                time.sleep(1.0)
                states = self.supervisor.states_as_served()
                if not states and not self.supervisor.is_alive():
                    return self._end_without_supervisor()
                for state in states:
                    if state.state == "RUNNING" and starts.get(state.name) != state.started_at_s:
                        print(f"{state.name} had ended and runs again; see {self.places.logs / state.name}.log", flush=True)
                        starts[state.name] = state.started_at_s
        except KeyboardInterrupt:
            self._stop_quietly()
            return 0

    def _end_without_supervisor(self) -> int:
        if not self.places.instance.exists():
            print("Stopped by ./run --stop.", flush=True)
            return 0
        print("The supervisor has been killed; everything stops. Start it again with ./run", file=sys.stderr)
        self.supervisor.end_leftovers()
        self.places.instance.unlink(missing_ok=True)
        remove_sockets(self.places.state)
        return 1

    # --- showing and stopping ----------------------------------------------------------------------------------------------------

    def _find_supervisor(self) -> Supervisor:
        return Supervisor(self.places, socket_directory(self.places.state))

    def show_status(self) -> int:
        states: list[ProgramState] = self._find_supervisor().states_as_served()
        port = _instance(self.places).get("port")
        if not states or port is None:
            print(f"Spanwise is not running on {self.places.state}")
            return EXIT_NOT_RUNNING
        reasons = reasons_not_ready(port)
        print(f"Spanwise at {address(port)} is {'not ready: ' + '; '.join(reasons) if reasons else 'ready'}")
        print(f"state folder {self.places.state}")
        for state in states:
            print(f"  {state.name:<16} {state.state.lower():<9} {state.description}")
        return 1 if reasons else 0

    def stop(self) -> int:
        if not self.places.state.is_dir():
            print(f"Nothing runs on {self.places.state}")
            return 0
        supervisor = self._find_supervisor()
        was_running = bool(supervisor.states())
        self.places.instance.unlink(missing_ok=True)
        supervisor.stop()
        remove_sockets(self.places.state)
        print("Stopped. The data stay." if was_running else f"Nothing runs on {self.places.state}")
        return 0


def _interrupt(number: int, frame: FrameType | None) -> NoReturn:
    raise KeyboardInterrupt


def main(arguments: list[str]) -> int:
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, _interrupt)
    options = parse(arguments, PROJECT_DIR)
    os.environ["SPANWISE_VAR"] = str(options.var)
    installation = Installation(options)
    try:
        if options.status:
            return installation.show_status()
        if options.stop:
            return installation.stop()
        return installation.start()
    except CannotStart as error:
        print(f"Spanwise could not start: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
