"""The task of the worker for proofs, which alone imports it, and OR-tools with it: see config/settings.py and scripts/commands.py."""

from time import monotonic

from celery import shared_task
from django.conf import settings

from missions.services.plan_proofs import prove_for_job
from missions.tasks import HARD_LIMIT_S, SOFT_LIMIT_S, noted_by, run_job
from planning.solver.proof import prove
from workspace.jobs.job_watch import JobWatch
from workspace.models import Job

MAX_PROOF_S = 180.0  # of all plans that are tried on the way; then the best until then is kept


@shared_task(soft_time_limit=SOFT_LIMIT_S, time_limit=HARD_LIMIT_S)
def prove_mission(job_id: str) -> None:
    """Look for a better plan of a mission, and prove how good its plan is. If stopped, what is known until then is kept."""
    until_s = monotonic() + MAX_PROOF_S

    def do(job: Job, watch: JobWatch) -> None:
        prove_for_job(
            job=job,
            prover=prove,
            stop=lambda: watch.stop() or monotonic() > until_s,
            on_progress=noted_by(watch),
            search_s=settings.ROUTING_RULES.large_plan_search_s,
        )

    run_job(job_id, do)
