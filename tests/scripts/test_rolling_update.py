"""One web program after the other is told to stop and started again, as an update does it: nobody's request is lost."""

import http.client
import subprocess
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from scripts.installation.system_packages import find_program
from scripts.places import PROJECT_DIR, WEB_PROGRAMS, Places
from scripts.proxy.proxy import configuration
from scripts.supervision.programs import web_programs
from tests.scripts.ports import free_port

TIMEOUT_S = 120.0
CLIENTS = 4


class Site:
    """nginx with the written configuration, and granian with the options of the real programs, in front of a small application."""

    def __init__(self, folder: Path, nginx: str) -> None:
        self.places = Places(folder)
        self.places.process("proxy").mkdir(parents=True)
        self.port = free_port()
        path = folder / "nginx.conf"
        path.write_text(configuration(self.places, folder, self.port))
        self._programs = {program.name: program for program in web_programs(self.places, folder)}
        self._processes: dict[str, subprocess.Popen[bytes]] = {}
        with (folder / "proxy.log").open("ab") as log:
            self._proxy = subprocess.Popen([nginx, "-e", "stderr", "-c", str(path)], stdout=log, stderr=log)
        for name in WEB_PROGRAMS:
            self.start(name)

    def start(self, name: str) -> None:
        socket = self.places.state / f"{name}.sock"
        socket.unlink(missing_ok=True)
        command = [*self._programs[name].command[:-1], "tests.scripts.proxy.slow_application:application"]
        self._processes[name] = subprocess.Popen(command, cwd=PROJECT_DIR)
        wait_for(socket.exists)

    def stop(self, name: str) -> int:
        """As the supervisor does, and Kubernetes. Returns how it ended."""
        process = self._processes.pop(name)
        process.terminate()
        return process.wait(TIMEOUT_S)

    def ask(self, path: str, method: str = "GET") -> tuple[int, str]:
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=TIMEOUT_S)
        try:
            connection.request(method, path, body=b"{}" if method == "POST" else None)
            answer = connection.getresponse()
            return answer.status, answer.read().decode()
        finally:
            connection.close()

    def close(self) -> None:
        for process in [*self._processes.values(), self._proxy]:
            process.terminate()
        for process in [*self._processes.values(), self._proxy]:
            process.wait(TIMEOUT_S)


@pytest.fixture
def site() -> Iterator[Site]:
    nginx = find_program("nginx")
    if nginx is None:
        pytest.skip("nginx is not installed; ./run installs it")
    with tempfile.TemporaryDirectory(prefix="sw-", dir="/tmp") as name, ExitStack() as ending:
        made = Site(Path(name), nginx)
        ending.callback(made.close)
        wait_for(lambda: _is_answered(made))
        yield made


def wait_for(is_so: Callable[[], bool]) -> None:
    deadline_s = time.monotonic() + TIMEOUT_S
    while not is_so():
        assert time.monotonic() < deadline_s, "it never came"
        time.sleep(0.05)


def _is_answered(site: Site) -> bool:
    try:
        return site.ask("/api/quick")[0] == 200
    except OSError:
        return False


@pytest.mark.long
def test_no_request_is_lost_while_each_program_is_stopped_and_started_again(site: Site) -> None:
    answers: Counter[tuple[str, int]] = Counter()
    is_over = threading.Event()
    under_way: list[tuple[int, str]] = []

    def ask_on(method: str) -> None:
        while not is_over.is_set():
            try:
                answers[method, site.ask("/api/quick", method)[0]] += 1
            except OSError:
                answers[method, 0] += 1

    threads = [threading.Thread(target=ask_on, args=(method,)) for method in ("GET", "POST") * (CLIENTS // 2)]
    threads += [threading.Thread(target=lambda: under_way.append(site.ask("/api/slow", "POST"))) for _ in WEB_PROGRAMS]
    for thread in threads:
        thread.start()
    wait_for(lambda: answers.total() > 20)
    ended = []
    for name in WEB_PROGRAMS:
        ended.append(site.stop(name))
        wait_for(lambda: answers.total() > 20)
        site.start(name)
        before = answers.total()
        wait_for(lambda before=before: answers.total() > before + 20)  # type: ignore[misc]
    is_over.set()
    for thread in threads:
        thread.join(TIMEOUT_S)
    assert ended == [0, 0]
    assert under_way == [(200, "slow"), (200, "slow")]
    assert {key: number for key, number in answers.items() if key[1] != 200} == {}
