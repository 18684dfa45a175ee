"""What is made once stays and is shared; what a request leaves in circles goes again."""

import ctypes
import subprocess
import sys

import pytest

only_gnu = pytest.mark.skipif(
    not hasattr(ctypes.CDLL(None), "malloc_trim"), reason="only the GNU C library gives back what is not at the end"
)

ANSWERS = """
import gc, weakref
from operation.garbage_collection import collect_rarely, freeze_startup_objects

class Answer:
    def __init__(self):
        self.rows = [[self] for _ in range(400)]

collect_rarely()
start = [[] for _ in range(800_000)]
freeze_startup_objects()
under_way, made = [], []
for _ in range(20_000):  # of which 20 are under way at any time, so that some are old before they are left
    under_way.append(Answer())
    made.append(weakref.ref(under_way[-1]))
    del under_way[:-20]
print(gc.get_freeze_count() >= 800_000, sum(answer() is not None for answer in made[:-5_000]))
"""


@pytest.mark.long
def test_what_grew_old_while_it_was_used_is_found_once_it_is_garbage():
    reported = subprocess.run([sys.executable, "-c", ANSWERS], capture_output=True, text=True, check=True, timeout=60)

    assert reported.stdout.split() == ["True", "0"]


BEFORE_A_FORK = """
import gc
import config
from celery.signals import worker_before_create_process
before = len(gc.get_objects())
worker_before_create_process.send(sender=None)
print(gc.get_freeze_count() > 0.9 * before)
"""


def test_a_worker_keeps_its_start_before_it_makes_processes_which_then_share_it():
    reported = subprocess.run([sys.executable, "-c", BEFORE_A_FORK], capture_output=True, text=True, check=True, timeout=60)

    assert reported.stdout.split() == ["True"]


OWN_MEMORY = """
def own_mib():
    with open("/proc/self/smaps_rollup") as lines:
        return int(next(line.split()[1] for line in lines if line.startswith("Anonymous:"))) / 1024
"""

AFTER_A_TASK = """
import gc, weakref
from operation.garbage_collection import trim_memory

class Answer:
    def __init__(self):
        self.itself = self

gc.disable()
left = weakref.ref(Answer())
held = [bytes(1_000) for _ in range(60_000)]
last = bytes(1_000)
most_mib = own_mib()
del held
before_mib = own_mib()
trim_memory()
print(left() is None, most_mib - before_mib < 10, most_mib - own_mib() > 40)
"""


@only_gnu
def test_after_a_task_circles_go_and_memory_before_something_that_stays_is_given_back():
    reported = subprocess.run([sys.executable, "-c", OWN_MEMORY + AFTER_A_TASK], capture_output=True, text=True, check=True, timeout=60)

    assert reported.stdout.split() == ["True", "True", "True"]


WORKER_PROCESS = """
import gc, weakref
from config.celery import app
from celery.signals import task_postrun, worker_process_init

class Answer:
    def __init__(self):
        self.itself = self

app.amqp.queues.select(["simulation"])
gc.disable()
first = weakref.ref(Answer())
task_postrun.send(sender=None)
is_there_elsewhere = first() is not None
worker_process_init.send(sender=None)
second = weakref.ref(Answer())
task_postrun.send(sender=None)
print(is_there_elsewhere, second() is None)
"""


def test_a_worker_process_gives_back_after_each_task_and_nothing_else_does():
    reported = subprocess.run([sys.executable, "-c", WORKER_PROCESS], capture_output=True, text=True, check=True, timeout=60)

    assert reported.stdout.split() == ["True", "True"]


NOW_AND_THEN = """
import gc, time, weakref
from operation import garbage_collection

class Answer:
    def __init__(self):
        self.itself = self

gc.disable()
left = weakref.ref(Answer())
garbage_collection.INTERVAL_S = 0.2
held = [bytes(1_000) for _ in range(60_000)]
last = bytes(1_000)
most_mib = own_mib()
del held
garbage_collection.trim_memory_periodically()
until_s = time.monotonic() + 20.0
while (left() is not None or most_mib - own_mib() < 40) and time.monotonic() < until_s:
    time.sleep(0.05)
print(left() is None, most_mib - own_mib() > 40)
"""


@only_gnu
def test_in_a_program_that_never_ends_circles_go_and_what_is_free_is_given_back():
    reported = subprocess.run([sys.executable, "-c", OWN_MEMORY + NOW_AND_THEN], capture_output=True, text=True, check=True, timeout=60)

    assert reported.stdout.split() == ["True", "True"]
