"""What is made once stays and is shared; what a request leaves in circles goes again."""

import subprocess
import sys

ANSWERS = """
import gc, weakref
from operation.garbage import collect_rarely, keep_what_is_there

class Answer:
    def __init__(self):
        self.rows = [[self] for _ in range(400)]

collect_rarely()
start = [[] for _ in range(800_000)]
keep_what_is_there()
under_way, made = [], []
for _ in range(20_000):  # of which 20 are under way at any time, so that some are old before they are left
    under_way.append(Answer())
    made.append(weakref.ref(under_way[-1]))
    del under_way[:-20]
print(gc.get_freeze_count() >= 800_000, sum(answer() is not None for answer in made[:-5_000]))
"""


def test_what_grew_old_while_it_was_used_is_found_once_it_is_garbage():
    told = subprocess.run([sys.executable, "-c", ANSWERS], capture_output=True, text=True, check=True, timeout=60)

    assert told.stdout.split() == ["True", "0"]


BEFORE_A_FORK = """
import gc
import config
from celery.signals import worker_before_create_process
before = len(gc.get_objects())
worker_before_create_process.send(sender=None)
print(gc.get_freeze_count() > 0.9 * before)
"""


def test_a_worker_keeps_its_start_before_it_makes_processes_which_then_share_it():
    told = subprocess.run([sys.executable, "-c", BEFORE_A_FORK], capture_output=True, text=True, check=True, timeout=60)

    assert told.stdout.split() == ["True"]
