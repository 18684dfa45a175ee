"""The supervisor with real processes: it starts them again after a kill -9, and nothing outlives it."""

import os
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import psycopg
import pytest

from config.private_servers import DATABASE_NAME, DATABASE_ROLE
from scripts.installation.database_cluster import create_database, database_exists, prepare_cluster, wait_for_database, wait_for_queue
from scripts.places import Places, prepare_sockets, prepare_state, remove_sockets
from scripts.supervision import supervision
from scripts.supervision.processes import processes_in
from scripts.supervision.programs import SERVERS_STAGE, Program, database_server, queue_server, web_programs
from scripts.supervision.supervision import Supervisor


@pytest.fixture
def places() -> Iterator[Places]:
    """A state in a folder that PostgreSQL's user can reach; the percent sign is special to the supervisor's parser."""
    folder = Path(tempfile.mkdtemp(prefix="spanwise-test-"))
    folder.chmod(0o755)
    yield prepare_state(folder / "50%")
    shutil.rmtree(folder)


@pytest.fixture
def sockets(places: Places) -> Iterator[Path]:
    yield prepare_sockets(places.state)
    remove_sockets(places.state)


@pytest.fixture
def supervisor(places: Places, sockets: Path) -> Iterator[Supervisor]:
    supervisor = Supervisor(places, sockets)
    yield supervisor
    supervisor.stop()
    assert not supervisor.is_alive()


def _wait_until(is_so: Callable[[], bool], *, timeout_s: float = 20.0) -> None:
    deadline = time.monotonic() + timeout_s
    while not is_so():
        assert time.monotonic() < deadline
        time.sleep(0.05)


def test_a_program_that_the_proxy_asks_runs_only_once_it_serves(supervisor: Supervisor, places: Places, sockets: Path) -> None:
    code = f"""
import pathlib, socket, time
while not pathlib.Path({str(places.state / "loaded")!r}).exists(): time.sleep(0.05)
listening = socket.socket(socket.AF_UNIX); listening.bind({str(sockets / "web-1.sock")!r}); listening.listen(); time.sleep(60)"""
    program = places.state / "program.py"
    program.write_text(code)
    folder = places.process("web-1")
    folder.mkdir(parents=True)
    supervisor.start([Program(name="web-1", stage=SERVERS_STAGE, command=[sys.executable, str(program)], folder=folder)])
    _wait_until(lambda: [state.state for state in supervisor.states()] == ["RUNNING"])
    assert [(state.state, state.description) for state in supervisor.states_as_served()] == [("STARTING", "does not serve yet")]
    (places.state / "loaded").touch()
    _wait_until(lambda: [state.state for state in supervisor.states_as_served()] == ["RUNNING"])


def _server_with_worker(places: Places) -> Program:
    """A server whose worker outlives it, like nginx's or Granian's, and keeps what the next server needs."""
    code = "import os, time; os.fork(); time.sleep(60)"
    folder = places.process("server")
    folder.mkdir(parents=True)
    return Program(name="server", stage=SERVERS_STAGE, command=[sys.executable, "-c", code], folder=folder)


def test_a_killed_server_runs_again_without_the_killed_ones_workers(places: Places, supervisor: Supervisor) -> None:
    program = _server_with_worker(places)
    supervisor.start([program])
    _wait_until(lambda: len(processes_in([program.folder])) == 2)
    before = set(processes_in([program.folder]))
    os.kill(min(before), signal.SIGKILL)
    _wait_until(lambda: len(now := set(processes_in([program.folder]))) == 2 and not now & before)


def test_stopping_leaves_nothing_behind(places: Places, supervisor: Supervisor) -> None:
    program = _server_with_worker(places)
    supervisor.start([program])
    _wait_until(lambda: len(processes_in([program.folder])) == 2)
    supervisor.stop()
    assert processes_in([program.folder]) == []
    assert supervisor.states() == []


def test_a_supervisor_that_was_killed_can_be_started_again(places: Places, supervisor: Supervisor) -> None:
    program = _server_with_worker(places)
    supervisor.start([program])
    _wait_until(lambda: len(processes_in([program.folder])) == 2)
    before = set(processes_in([program.folder]))
    [supervisor_process] = processes_in([places.process("supervisor")])
    os.kill(supervisor_process, signal.SIGKILL)
    supervisor.start([program])
    _wait_until(lambda: len(processes_in([program.folder])) == 2)
    assert not before & set(processes_in([program.folder]))


def test_a_supervisor_that_hangs_is_ended_with_all_it_runs(places: Places, supervisor: Supervisor, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(supervision, "CALL_TIMEOUT_S", 0.5)
    monkeypatch.setattr(supervision, "TIMEOUT_WITH_SUPERVISOR_S", 0.5)
    program = _server_with_worker(places)
    supervisor.start([program])
    _wait_until(lambda: len(processes_in([program.folder])) == 2)
    [supervisor_process] = processes_in([places.process("supervisor")])
    os.kill(supervisor_process, signal.SIGSTOP)
    supervisor.stop()
    assert not supervisor.is_alive()
    assert processes_in([program.folder]) == []


def test_what_the_database_acknowledged_survives_kill_9_and_a_used_again_process_id(
    places: Places, sockets: Path, supervisor: Supervisor
) -> None:
    prepare_cluster(places)
    servers = [database_server(places, sockets), queue_server(places, sockets)]
    supervisor.start(servers)
    wait_for_database(sockets)
    wait_for_queue(sockets)
    create_database(sockets)
    with psycopg.connect(host=str(sockets), user=DATABASE_ROLE, dbname=DATABASE_NAME) as connection:
        connection.execute("CREATE TABLE mission AS SELECT 1 AS id")
    lock = places.data / "postmaster.pid"
    [supervisor_process] = processes_in([places.process("supervisor")])
    os.kill(supervisor_process, signal.SIGSTOP)  # so that the lock can be changed before the next start
    try:
        os.kill(int(lock.read_text().splitlines()[0]), signal.SIGKILL)
        _wait_until(lambda: not processes_in([places.data]))
        lines = lock.read_text().splitlines(keepends=True)
        lock.write_text("".join([f"{os.getpid()}\n", *lines[1:]]))
    finally:
        os.kill(supervisor_process, signal.SIGCONT)
    wait_for_database(sockets)
    assert database_exists(sockets)
    with psycopg.connect(host=str(sockets), user=DATABASE_ROLE, dbname=DATABASE_NAME) as connection:
        assert connection.execute("SELECT id FROM mission").fetchone() == (1,)


def test_every_queue_of_the_settings_has_a_worker(places: Places, settings: object) -> None:
    queues = {settings.CELERY_TASK_DEFAULT_QUEUE, *(route["queue"] for route in settings.CELERY_TASK_ROUTES.values())}  # type: ignore[attr-defined]
    served = {
        program.command[program.command.index("--queues") + 1]
        for program in web_programs(places, Path("/sockets"))
        if "--queues" in program.command
    }
    assert queues == served
