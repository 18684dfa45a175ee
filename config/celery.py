"""The Celery application, whose queues are

`data` (imports, graph), `flight` (urgent for UAVs on a mission: starts, ends of commands, alerts), `planning` (large plans), `proofs`
(better bounds and plans, of low priority) and `simulation` (rehearsals).
"""

import os

from celery import Celery
from celery.signals import beat_init, task_postrun, worker_before_create_process, worker_process_init

from config.instrumentation.task_instrumentation import LoopPulse, watch_tasks
from config.worker_shutdown import SoftEnd
from operation.garbage_collection import freeze_startup_objects, trim_memory
from operation.program import program_begins
from operation.tracing import begin_tracing

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
app = Celery("spanwise")
app.config_from_object("django.conf:settings", namespace="CELERY")
app.autodiscover_tasks()
app.steps["worker"].update({LoopPulse, SoftEnd})
watch_tasks()


PROOF_NICENESS = 15  # proofs give way to every other program
WITHOUT_WARM_UP = {"data", "flight", "proofs", "simulation"}  # no user waits for their plans


@worker_before_create_process.connect
def keep_before_fork(**_: object) -> None:
    """Freeze objects before a fork: a collection writes to every object that it traverses, which would unshare 80 MiB per process."""
    freeze_startup_objects()


@worker_process_init.connect
def warm_up_process(**_: object) -> None:
    """Load what plans need before a worker's process takes a task, where users wait for plans."""
    queues = set(app.amqp.queues.consume_from)
    if queues == {"proofs"}:
        os.nice(PROOF_NICENESS)
    if not queues <= WITHOUT_WARM_UP:
        from missions.services import warm_up  # noqa: PLC0415 (Django is set up only when this runs)

        begin_tracing("worker")
        warm_up()
    freeze_startup_objects()
    task_postrun.connect(trim_memory_after_task)  # only here: a test that runs a task in its own process has many objects to traverse


def trim_memory_after_task(**_: object) -> None:
    trim_memory()


@beat_init.connect
def report_the_installation(**_: object) -> None:
    """Export installation metrics from the schedule, of which there is one process."""
    from config.instrumentation.system_metrics import InstallationState  # noqa: PLC0415 (Django is set up by then, not when this module is read)

    InstallationState(app).snapshot().__enter__()
    program_begins("beat")
