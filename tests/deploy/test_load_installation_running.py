"""The installation of the load tests, started: TLS, redirect, kills, and replicas that come and go behind the proxy."""

import http.client
import ssl
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from deploy.load.installation import Installation

pytestmark = pytest.mark.long

TIMEOUT_S = 300.0
WITHOUT = dict.fromkeys(
    ("live", "worker-data", "worker-flight", "worker-planning", "worker-simulation", "gateway", "estimator", "simulator", "beat"), 0
)


@pytest.fixture(params=[False, True], ids=["sockets", "names"])
def installation(request: pytest.FixtureRequest) -> Iterator[Installation]:
    with TemporaryDirectory(prefix="sw-load-") as folder:
        Path(folder).chmod(0o711)  # PostgreSQL's own user goes through it
        spare = {"web": 1} if request.param else {}
        with Installation(Path(folder), WITHOUT | {"web": 2}, spare=spare, by_name=request.param) as running:
            yield running


class Visitors:
    """Ask for a page over and over on kept connections, and note whatever is not an answer."""

    def __init__(self, installation: Installation) -> None:
        self.installation, self.faults, self.answers, self.is_over = installation, [], 0, False
        self.threads = [threading.Thread(target=self._ask) for _ in range(4)]

    def __enter__(self) -> "Visitors":
        for thread in self.threads:
            thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.is_over = True
        for thread in self.threads:
            thread.join()

    def wait_for_more(self, answers: int) -> None:
        wanted, end_s = self.answers + answers, time.monotonic() + TIMEOUT_S
        while self.answers < wanted and time.monotonic() < end_s:
            time.sleep(0.05)
        assert self.answers >= wanted

    def _ask(self) -> None:
        connection = http.client.HTTPSConnection("localhost", self.installation.port, timeout=120, context=self.installation.trust())
        while not self.is_over:
            try:
                connection.request("GET", "/healthz")
                answer = connection.getresponse()
                answer.read()
                if answer.status != 200:
                    self.faults.append(f"{answer.status}")
            except (OSError, http.client.HTTPException) as error:
                self.faults.append(repr(error))
                connection.close()
            self.answers += 1
            time.sleep(0.02)
        connection.close()


def test_a_killed_replica_and_one_that_goes_lose_no_request(installation: Installation) -> None:
    with Visitors(installation) as visitors:
        visitors.wait_for_more(20)
        pid = installation.kill("web-1")
        installation.wait_for_another("web-1", pid)
        while not installation.is_ready("web-1"):
            visitors.wait_for_more(1)
        visitors.wait_for_more(20)
        if installation.name_server:
            (spare,) = installation.spare_names("web")
            installation.start(spare)
            while not installation.is_ready(spare):
                visitors.wait_for_more(1)
            installation.let_in(spare)
            visitors.wait_for_more(20)
            installation.keep_out("web-2")
            time.sleep(3.0)  # the proxy's own time: what it has been told it keeps for two seconds
        installation.stop("web-2")
        visitors.wait_for_more(20)
    assert visitors.faults == []


def test_it_speaks_tls_as_shipped(installation: Installation) -> None:
    connection = http.client.HTTPConnection("localhost", installation.plain_port, timeout=60)
    connection.request("GET", "/sign-in")
    answer = connection.getresponse()
    assert (answer.status, answer.headers["Location"]) == (308, "https://localhost/sign-in")
    with urllib.request.urlopen(f"{installation.address}/sign-in", timeout=120, context=installation.trust()) as page:
        assert "max-age=31536000" in page.headers["Strict-Transport-Security"]
        assert "Secure" in page.headers["Set-Cookie"]
    with pytest.raises(urllib.error.URLError, match="CERTIFICATE_VERIFY_FAILED"):
        urllib.request.urlopen(installation.address, timeout=60, context=ssl.create_default_context())
    old = installation.trust()
    old.minimum_version, old.maximum_version = ssl.TLSVersion.TLSv1, ssl.TLSVersion.TLSv1_1
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(installation.address, timeout=60, context=old)
    assert {"web-1", "web-2", "proxy", "postgresql", "redis"} <= installation.usage().keys()
