"""Reads of the workspace."""

from uuid import UUID

from django.db.models import QuerySet

from workspace.models import Job, Organisation


def jobs_of_organisation(organisation: Organisation) -> QuerySet[Job]:
    return Job.objects.filter(organisation=organisation)


def job_of_organisation(organisation: Organisation, job_id: UUID) -> Job:
    """Return a job. Raises Job.DoesNotExist also for another organisation's job."""
    return jobs_of_organisation(organisation).get(pk=job_id)
