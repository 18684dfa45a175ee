"""A task knows the request that it was asked for in, and is counted with its outcome."""

import threading
import time
from collections.abc import Callable, Iterator
from uuid import uuid4

import pytest
from celery.contrib.testing.worker import start_worker
from celery.signals import worker_process_init
from prometheus_client import REGISTRY

from config.celery import app, warm_up_process
from operation.log_context import about, facts

TIMEOUT_S = 120

_received: list[dict[str, str]] = []
_is_done = threading.Event()


@app.task(name="tests.note_what_it_is_about")
def note_what_it_is_about(job_id: str) -> None:
    _received.append(dict(facts()))
    _is_done.set()


@app.task(name="tests.fall")
def fall() -> None:
    _is_done.set()
    raise ValueError("as it should")


@pytest.fixture(autouse=True)
def _nothing_received() -> None:
    _received.clear()
    _is_done.clear()


@pytest.fixture(scope="module")
def queue() -> Iterator[str]:
    """A real worker of Spanwise's own application, in a thread, at a queue of its own."""
    name = f"watched-{uuid4().hex[:8]}"
    worker_process_init.disconnect(warm_up_process)  # nothing is planned here
    with start_worker(app, pool="solo", perform_ping_check=False, queues=[name], shutdown_timeout=TIMEOUT_S):
        yield name
    worker_process_init.connect(warm_up_process)


def wait_for(is_so: Callable[[], bool]) -> None:
    deadline_s = time.monotonic() + TIMEOUT_S
    while not is_so():
        assert time.monotonic() < deadline_s, "it never came"
        time.sleep(0.02)


def counted(task: str, outcome: str) -> float:
    return REGISTRY.get_sample_value("spanwise_tasks_total", {"task": task, "outcome": outcome}) or 0.0


def test_what_the_work_is_about_goes_with_a_task(queue: str) -> None:
    before = counted(note_what_it_is_about.name, "done")
    with about(request="request-of-today", mission="m-7", uav="3", job="another"):
        note_what_it_is_about.apply_async(args=["job-9"], queue=queue)
    assert _is_done.wait(TIMEOUT_S)
    assert _received == [{"request": "request-of-today", "mission": "m-7", "uav": "3", "job": "job-9"}]
    wait_for(lambda: counted(note_what_it_is_about.name, "done") == before + 1)


def test_a_task_of_nobodys_request_is_about_its_job_alone_and_a_failed_one_is_counted_so(queue: str) -> None:
    before = counted(fall.name, "failed")
    note_what_it_is_about.apply_async(args=["job-9"], queue=queue)
    assert _is_done.wait(TIMEOUT_S)
    assert _received == [{"job": "job-9"}]
    _is_done.clear()
    fall.apply_async(queue=queue)
    assert _is_done.wait(TIMEOUT_S)
    wait_for(lambda: counted(fall.name, "failed") == before + 1)
    assert facts() == {}
