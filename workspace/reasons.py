"""Texts of the codes of how a job ended."""

from operation.reasons import gettext_noop, register_sentences

SENTENCES = register_sentences({
    "job_cancelled": gettext_noop("Cancelled"),
    "job_time_limit": gettext_noop("Not done within the time limit; it is not tried again."),
    "worker_lost": gettext_noop("The worker was lost %(times)s times; the job is given up."),
})  # fmt: skip
