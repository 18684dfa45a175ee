"""A worker that is told to stop (SIGTERM) finishes what is short, gives back what is long, and ends by itself."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from uuid import uuid4

import pytest
from celery import Celery
from django.conf import settings
from redis import Redis

TIMEOUT_S = 180.0


class Queue:
    """A queue of its own, and what its tasks have noted."""

    def __init__(self, folder: Path) -> None:
        self.name = f"slow-{uuid4().hex[:8]}"
        self.folder = folder
        self.redis = Redis.from_url(settings.REDIS_URL)
        self.app = Celery("sender", broker=settings.CELERY_BROKER_URL, set_as_current=False)

    def send(self, seconds: float, task: str = "take") -> None:
        self.app.send_task(f"tests.config.slow_tasks.{task}", args=[seconds], queue=self.name)

    def notes(self) -> list[str]:
        return [note.decode() for note in self.redis.lrange(f"{self.name}.notes", 0, -1)]

    @contextmanager
    def worker(self, *, warm_up_s: float = 0.0) -> Iterator[subprocess.Popen[bytes]]:
        """As scripts/supervision/programs.py starts one: TERM says the same as QUIT."""
        environment = os.environ | {"SLOW_QUEUE": self.name, "SLOW_WARM_UP_S": str(warm_up_s), "REDIS_URL": settings.REDIS_URL}
        environment |= {
            "REMAP_SIGTERM": "SIGQUIT",
            "SPANWISE_VAR": str(self.folder),
            "SPANWISE_SECRET_KEY": "of-the-test",
            "SPANWISE_METRICS": "",
        }
        command = [sys.executable, "-m", "celery", "--app", "tests.config.slow_tasks", "--quiet", "worker", "--queues", self.name]
        command += ["--concurrency", "3", "--hostname", f"{uuid4()}@%h", "--without-mingle", "--without-gossip", "--without-heartbeat"]
        process = subprocess.Popen(command, cwd=settings.BASE_DIR, env=environment, start_new_session=True)  # noqa: S603
        try:
            yield process
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
            process.wait(TIMEOUT_S)


@pytest.fixture
def queue(tmp_path: Path) -> Iterator[Queue]:
    made = Queue(tmp_path)
    yield made
    made.redis.delete(made.name, f"{made.name}.notes", f"_kombu.binding.{made.name}")


def wait_for(is_so: Callable[[], bool]) -> None:
    deadline_s = time.monotonic() + TIMEOUT_S
    while not is_so():
        assert time.monotonic() < deadline_s, "it never came"
        time.sleep(0.05)


@pytest.mark.long
def test_of_what_a_worker_has_under_way_nothing_is_lost_when_it_is_told_to_stop(queue: Queue) -> None:
    """What is short it finishes, what is long the next one gets, and what does not hear that it is to end is ended. On a machine that is
    busy with other things the next one may get all three.
    """
    with queue.worker() as process:
        queue.send(1.0)
        queue.send(3_600.0)
        queue.send(3_600.0, "take_and_receive_nothing")
        wait_for(lambda: queue.notes().count("began") == 3)
        process.terminate()
        assert process.wait(TIMEOUT_S) >= 0, "it had to be killed"
    with queue.worker():
        wait_for(lambda: queue.notes().count("began") >= 5 and "done" in queue.notes())


@pytest.mark.long
def test_a_process_that_still_warms_up_holds_up_no_end(queue: Queue) -> None:
    """It hears no signal meanwhile; a task that was meant for it is the next worker's."""
    with queue.worker(warm_up_s=3_600.0) as process:
        wait_for(lambda: "warms up" in queue.notes())
        queue.send(0.0)
        process.terminate()
        assert process.wait(TIMEOUT_S) >= 0, "it had to be killed"
    with queue.worker():
        wait_for(lambda: "done" in queue.notes())
    assert queue.notes().count("began") == 1
