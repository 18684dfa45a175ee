"""What jobs say is stored as reasons and in English, and read in the reader's language."""

from importlib import import_module
from typing import Any

import pytest
from django.apps import apps
from django.db import connection
from django.utils import timezone

from operation.reasons import Reason
from tests.accounts.users import a_user, client_of
from workspace.jobs.services import create_job, fail_job, report_progress, start_job
from workspace.models import Job, User

pytestmark = pytest.mark.django_db


def running(user: User) -> Job:
    waiting = Reason("waiting_to_be_fetched")
    made = create_job(
        organisation=user.organisation, created_by=user, task="inspection.tasks.read_proposal", parameters={}, message=waiting
    )
    job = start_job(job_id=made.pk)
    assert job is not None
    return job


def shown(user: User, job: Job, language: str) -> Any:
    return client_of(user).get(f"/api/v1/jobs/{job.pk}", headers={"Accept-Language": language}).json()


def test_a_stage_is_read_in_german_and_stored_in_english() -> None:
    user = a_user()
    job = running(user)
    report_progress(job=job, progress=0.1, message=Reason("size_from_overpass", {"size": 12.5}))
    job.refresh_from_db()
    assert job.message == "12.5 MiB from Overpass"
    german = shown(user, job, "de")
    assert (german["message"], german["why"]) == ("12,5 MiB von Overpass", [{"code": "size_from_overpass", "params": {"size": 12.5}}])


def test_an_error_is_read_in_german_and_a_quoted_one_stays_as_it_is() -> None:
    user = a_user()
    job = running(user)
    fail_job(job=job, code="invalid", message=Reason("file_unreadable", {"error": "gzip: bad magic"}))
    job.refresh_from_db()
    assert job.error["message"] == "The file cannot be read: gzip: bad magic"
    german = shown(user, job, "de")
    assert german["error"]["message"] == german["message"] == "Die Datei kann nicht gelesen werden: gzip: bad magic"
    assert [reason["code"] for reason in german["error"]["why"]] == ["file_unreadable"]


def test_what_the_version_before_writes_is_read_as_it_wrote_it() -> None:
    user = a_user()
    job = running(user)
    Job.objects.filter(pk=job.pk).update(message="reading the rows, row 7", error={"code": "internal", "message": "Something else."})
    german = shown(user, job, "de")
    assert (german["message"], german["why"]) == ("reading the rows, row 7", [])
    assert german["error"] == {"code": "internal", "message": "Something else.", "why": []}


def test_the_migration_gives_codes_to_fixed_sentences_alone() -> None:
    user = a_user()
    ended, other = running(user), running(user)
    failed = "The planner failed; the error is in the log."
    error = {"code": "internal", "message": failed}
    Job.objects.filter(pk=ended.pk).update(finished_at=timezone.now(), message=failed, message_why=None, error=error)
    Job.objects.filter(pk=other.pk).update(message="12.5 MiB from Overpass", message_why=None)
    with connection.schema_editor() as editor:
        import_module("workspace.migrations.0003_codes_of_fixed_messages").give_codes(apps, editor)
    german = shown(user, ended, "de")
    assert german["message"] == german["error"]["message"] == "Der Planer ist gescheitert; der Fehler steht im Protokoll."
    assert shown(user, other, "de")["why"] == []
