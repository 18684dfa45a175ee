"""The web program serves before it is warm, and says until then that it is not ready."""

import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from django.conf import settings
from django.test import Client

from config.compiled import warming
from config.compiled.warming import WARMING_UP, warm_up_beside, warming_faults
from operation.readiness import Readiness
from tests.telemetry.gateway.station import wait_for

PROJECT_DIR = Path(__file__).resolve().parents[2]
TIMEOUT_S = 120

SERVED_MEANWHILE = """
import threading
import django
django.setup()
from missions import services
is_warm = threading.Event()
services.warm_up = is_warm.wait
import config.wsgi
from config.compiled.warming import warming_faults
assert warming_faults()
print(config.wsgi.application)
is_warm.set()
"""


@pytest.fixture(autouse=True)
def own_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(warming, "_thread", None)


@pytest.mark.django_db
def test_not_ready_until_it_is_warm_but_alive() -> None:
    is_warm = threading.Event()
    warm_up_beside(lambda: is_warm.wait(TIMEOUT_S) and None)
    answer = Client(raise_request_exception=False).get("/readyz")
    assert (answer.status_code, answer.json()) == (503, {"ready": False, "reasons": [WARMING_UP]})
    assert Readiness(warming_faults).faults() == [WARMING_UP]
    assert Client().get("/healthz").status_code == 200
    is_warm.set()
    wait_for(lambda: not warming_faults(), "the end of the warm-up")
    assert Client().get("/readyz").status_code == 200


def test_what_fails_keeps_nobody_out(caplog: pytest.LogCaptureFixture) -> None:
    def fail() -> None:
        raise MemoryError

    warm_up_beside(fail)
    wait_for(lambda: not warming_faults(), "the end of the warm-up")
    assert "not warmed up" in caplog.text


@pytest.mark.long
def test_the_application_is_there_before_it_is_warm() -> None:
    """Where it were not, this would wait for ever: nobody sets the event before."""
    environment = {**os.environ, "DJANGO_SETTINGS_MODULE": "config.settings", "SPANWISE_VAR": str(settings.STATE_DIR)}
    asked = [sys.executable, "-c", SERVED_MEANWHILE]
    done = subprocess.run(  # noqa: S603 - our own code
        asked, cwd=PROJECT_DIR, env=environment, capture_output=True, text=True, timeout=TIMEOUT_S, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "WSGIHandler" in done.stdout
