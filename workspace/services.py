"""Writes of the workspace: jobs from request to result, tokens, history."""

import hashlib
import secrets
from collections.abc import Iterable
from datetime import datetime, timedelta
from functools import partial
from typing import Any
from uuid import UUID

from celery import current_app
from django.conf import settings
from django.db import connection, transaction
from django.db.models import Q
from django.utils import timezone
from django.utils.translation import gettext as _

from workspace.live.changes import publish_job
from workspace.models import (
    DEFAULT_ORGANISATION_ID,
    OPEN_STATES,
    SCOPES_OF_ROLE,
    ApiToken,
    AuditEntry,
    IdempotencyKey,
    Invitation,
    Job,
    JobState,
    Organisation,
    Role,
    User,
)
from workspace.prepared_statements import prepared_rows

LEASE_S = 15  # a worker that says nothing for so long is taken for dead; it speaks once a second
QUEUE_TIMEOUT_S = 30  # a queued job that nobody took for so long is sent again
MAX_ATTEMPTS = 5
_ATTEMPTS_BEFORE = "attempts_before_pause"  # in a job's parameters
IDEMPOTENCY_KEPT = timedelta(hours=48)
USE_NOTED_EVERY = timedelta(minutes=1)
ADMINISTRATORS_LOCK = 0x05A7_0003  # advisory lock: one at a time takes the role away, or an administrator's access


class JobCancelled(Exception):
    """A user has asked the job to stop."""


class JobLost(JobCancelled):
    """Another worker holds the job by now, or it has ended: whatever this one still finds is of no use."""


class TooManyJobs(Exception):
    """The user has as many jobs waiting and running as one may have."""

    def __init__(self, limit: int) -> None:
        super().__init__(_("%(limit)s of your jobs are waiting or running already. Wait for one, or stop it.") % {"limit": limit})


class NoAdministratorLeft(ValueError):
    """Without an administrator who may sign in nobody could give the role back."""

    def __init__(self) -> None:
        super().__init__(_("This would leave no administrator who can sign in. Make somebody else an administrator first."))


class OperatorsAlone(PermissionError):
    """Whoever could change an installation operator's account could become one."""

    def __init__(self) -> None:
        super().__init__(_("Only installation operators change the account of one."))


def may_change(actor: User, user: User) -> bool:
    """Whether the actor may change this account: that of an installation operator is for operators and its owner."""
    return actor.operates_installation or actor.pk == user.pk or not user.operates_installation


def hash_token(token: str) -> str:
    return hashlib.sha256(token.encode()).hexdigest()


def create_api_token(*, user: User, name: str, expires_at: datetime, scopes: Iterable[str] | None = None) -> str:
    """Make a bearer token with these scopes, or all of the role, and return it; it cannot be shown again."""
    token = f"spw_{secrets.token_urlsafe(32)}"
    given = list(SCOPES_OF_ROLE[user.role] if scopes is None else scopes)
    ApiToken.objects.create(user=user, name=name, token_sha256=hash_token(token), expires_at=expires_at, scopes=given)
    return token


# Nobody waits for the disk: after a failure of power the last uses of a fraction of a second may be forgotten.
_NOTE_USE = """
    WITH quick AS (SELECT set_config('synchronous_commit', 'off', true))
    UPDATE workspace_apitoken SET last_used_at = %s FROM quick WHERE id = %s"""


def note_use(*, token: int, last_used_at: datetime | None) -> None:
    """When the token with this key was used last, to the minute: a script that asks often writes seldom."""
    now = timezone.now()
    if last_used_at is None or now - last_used_at >= USE_NOTED_EVERY:
        prepared_rows(_NOTE_USE, [now, token])


def record_change(
    *,
    organisation: Organisation,
    actor: User | None,
    action: str,
    subject_type: str,
    subject_id: object,
    before: Any = None,
    after: Any = None,
) -> AuditEntry:
    return AuditEntry.objects.create(
        organisation=organisation,
        actor=actor,
        action=action,
        subject_type=subject_type,
        subject_id=str(subject_id),
        before=before,
        after=after,
    )


def create_job(*, organisation: Organisation, created_by: User | None, task: str, parameters: dict[str, Any], message: str = "") -> Job:
    return Job.objects.create(organisation=organisation, created_by=created_by, task=task, parameters=parameters, message=message)


def create_job_within(
    limit: int, *, organisation: Organisation, created_by: User, task: str, parameters: dict[str, Any], message: str = ""
) -> Job:
    """As create_job, for a user with fewer than `limit` open jobs of this app. Raises TooManyJobs; of two at once the second waits."""
    with transaction.atomic():
        User.objects.select_for_update(no_key=True).filter(pk=created_by.pk).values_list("pk").first()
        refuse_jobs_beyond(limit, user=created_by, task=task)
        return create_job(organisation=organisation, created_by=created_by, task=task, parameters=parameters, message=message)


def refuse_jobs_beyond(limit: int, *, user: User, task: str) -> None:
    """Raises TooManyJobs when the user has `limit` open jobs, or more, of the app that the task is of."""
    app = task.partition(".")[0]
    if Job.objects.filter(created_by=user, state__in=OPEN_STATES, task__startswith=f"{app}.").count() >= limit:
        raise TooManyJobs(limit)


def start_job(*, job_id: UUID | str) -> Job | None:
    """Take the job for this worker, or return None if it is finished, cancelled or held by another worker."""
    now = timezone.now()
    with transaction.atomic():
        job = Job.objects.select_for_update().filter(pk=job_id).first()
        if job is None or not job.is_open:
            return None
        if job.is_held:
            return None
        if job.cancel_requested_at is not None:
            confirm_cancelled(job=job)
            return None
        if job.state == JobState.RUNNING and (_attempts_lost(job) >= MAX_ATTEMPTS or _has_used_its_time(job)):
            _give_up(job)
            return None
        job.state = JobState.RUNNING
        job.attempts += 1
        job.started_at = now
        job.lease_expires_at = now + timedelta(seconds=LEASE_S)
        job.best = None
        job.save()
        transaction.on_commit(partial(publish_job, job.pk))
    return job


def report_progress(*, job: Job, progress: float, message: str = "", best: Any = None) -> None:
    """Store how far the job is, the best found so far if there is something new, and renew its lease.

    Raises JobCancelled when the user has asked to stop (the lease is renewed all the same: what was found is still to be kept), and
    JobLost when this worker does not hold the job any more.
    """
    held = Job.objects.filter(pk=job.pk, state=JobState.RUNNING, attempts=job.attempts)
    values: dict[str, Any] = {"lease_expires_at": timezone.now() + timedelta(seconds=LEASE_S)}
    told = values | {"progress": min(max(progress, 0.0), 1.0), "message": message[:300]} | ({} if best is None else {"best": best})
    if not held.filter(cancel_requested_at=None).update(**told):
        raise JobCancelled if held.update(**values) else JobLost
    publish_job(job.pk)


def give_back_job(*, job: Job) -> bool:
    """The worker is told to stop: whoever gets the job's message next goes on with it at once, without waiting for the lease to run out."""
    held = Job.objects.filter(pk=job.pk, state=JobState.RUNNING, attempts=job.attempts)
    return bool(held.update(state=JobState.QUEUED, lease_expires_at=timezone.now() + timedelta(seconds=LEASE_S)))


def pause_job(*, job: Job, progress: float, message: str, pause_s: float) -> None:
    """Leave the worker to others, as the job waits for something: after `pause_s` the sweep sends it again.

    Attempts until now count no longer as lost. A job that is to be cancelled ends. Nothing happens if another worker has taken it over.
    """
    parameters = job.parameters | {_ATTEMPTS_BEFORE: job.attempts}
    held = Job.objects.filter(pk=job.pk, state=JobState.RUNNING, attempts=job.attempts, cancel_requested_at=None)
    again_at = timezone.now() + timedelta(seconds=pause_s)
    told = {"progress": progress, "message": message[:300], "parameters": parameters, "lease_expires_at": again_at}
    if held.update(state=JobState.QUEUED, **told):
        publish_job(job.pk)
    else:
        confirm_cancelled(job=job)


def _attempts_lost(job: Job) -> int:
    """Since it was paused last, or in all."""
    return job.attempts - int(job.parameters.get(_ATTEMPTS_BEFORE, 0))


def cancel_is_requested(*, job: Job) -> bool:
    return not Job.objects.filter(pk=job.pk, state=JobState.RUNNING, attempts=job.attempts, cancel_requested_at=None).exists()


def finish_job(*, job: Job, result: Any = None, message: str = "") -> bool:
    """Store the result once. False if another worker finished the job, or the user cancelled it, in the meantime."""
    return _end(job, state=JobState.DONE, progress=1.0, result=result, message=message[:300])


def fail_job(*, job: Job, code: str, message: str) -> None:
    _end(job, state=JobState.FAILED, error={"code": code, "message": message}, message=message[:300])


def _end(job: Job, **values: Any) -> bool:
    """End the job if this attempt still holds it. An attempt whose lease another one has taken ends nothing."""
    held = Job.objects.filter(pk=job.pk, state=JobState.RUNNING, attempts=job.attempts)
    ended = bool(held.update(**values, best=None, finished_at=timezone.now(), lease_expires_at=None))
    if ended:
        transaction.on_commit(partial(publish_job, job.pk))
    return ended


def _has_used_its_time(job: Job) -> bool:
    """Whether its worker was stopped at the time limit: the same again would end the same way, and hold a worker as long."""
    if job.started_at is None or job.lease_expires_at is None:
        return False
    heard_s = (job.lease_expires_at - job.started_at).total_seconds() - LEASE_S
    limit_s = getattr(current_app.tasks.get(job.task), "soft_time_limit", None) or settings.CELERY_TASK_SOFT_TIME_LIMIT
    return heard_s >= limit_s


def _give_up(job: Job) -> None:
    if _has_used_its_time(job):
        fail_job(job=job, code="took_too_long", message="Not done within the time limit; it is not tried again.")
        return
    fail_job(job=job, code="worker_lost", message=f"The worker was lost {MAX_ATTEMPTS} times; the job is given up.")


def confirm_cancelled(*, job: Job) -> None:
    """A worker has seen the request to stop and has stopped. Nothing happens if another worker has taken the job over since."""
    _end(job, state=JobState.CANCELLED, message="Cancelled")


def cancel_job(*, job: Job) -> Job:
    """Ask the job to stop: at once if nobody works on it yet, else at the worker's next look. A finished job stays as it is."""
    now = timezone.now()
    with transaction.atomic():
        locked = Job.objects.select_for_update().get(pk=job.pk)
        if locked.is_open:
            locked.cancel_requested_at = locked.cancel_requested_at or now
            if locked.state == JobState.QUEUED:
                locked.state = JobState.CANCELLED
                locked.message = "Cancelled"
                locked.finished_at = now
                locked.lease_expires_at = None
            locked.save()
            transaction.on_commit(partial(publish_job, locked.pk))
    return locked


def requeue_lost_jobs() -> list[Job]:
    """Put back what a dead worker held and find what nobody picked up; the caller sends these to the queue again.

    The lease of a queued job is the time until which a message for it is believed to be on its way.
    """
    now = timezone.now()
    patience = timedelta(seconds=QUEUE_TIMEOUT_S)
    lost = []
    with transaction.atomic():
        for job in Job.objects.select_for_update(skip_locked=True).filter(state=JobState.RUNNING, lease_expires_at__lt=now):
            if job.cancel_requested_at is not None:
                confirm_cancelled(job=job)
            elif _attempts_lost(job) >= MAX_ATTEMPTS or _has_used_its_time(job):
                _give_up(job)
            else:
                Job.objects.filter(pk=job.pk).update(state=JobState.QUEUED, lease_expires_at=now)
                lost.append(job.pk)  # sent at once, however new it is
        is_due = Q(pk__in=lost) | Q(lease_expires_at=None, created_at__lt=now - patience) | Q(lease_expires_at__lt=now)
        jobs = list(Job.objects.select_for_update(skip_locked=True).filter(is_due, state=JobState.QUEUED))
        Job.objects.filter(pk__in=[job.pk for job in jobs]).update(lease_expires_at=now + patience)
    return jobs


def forget_old_idempotency_keys() -> int:
    deleted, _ = IdempotencyKey.objects.filter(created_at__lt=timezone.now() - IDEMPOTENCY_KEPT).delete()
    return deleted


def save_person(*, user: User, actor: User) -> User:
    """Store a new or changed account. Raises NoAdministratorLeft, OperatorsAlone."""
    with transaction.atomic():
        before = User.objects.filter(pk=user.pk).first()
        if before and not may_change(actor, before):
            raise OperatorsAlone
        user.save()
        _refuse_without_administrator(before)
        if before and _administrates(before) and not (_administrates(user) and before.organisation_id == user.organisation_id):
            _withdraw_invitations(user, actor)
        _record_person(actor, user.pk, person_facts(before) if before else None, person_facts(user))
    return user


def change_people(*, users: Iterable[User], actor: User, role: Role | None = None, is_active: bool | None = None) -> int:
    """Give several accounts a role, or let them in or keep them out; return how many were changed. Raises as save_person."""
    changed = 0
    with transaction.atomic():
        for user in users:
            wanted = (user.role if role is None else role, user.is_active if is_active is None else is_active)
            if wanted != (user.role, user.is_active):
                user.role, user.is_active = wanted
                save_person(user=user, actor=actor)
                changed += 1
    return changed


def delete_person(*, user: User, actor: User) -> None:
    """What they did stays in the history, without their name. Raises NoAdministratorLeft, OperatorsAlone."""
    if not may_change(actor, User.objects.get(pk=user.pk)):
        raise OperatorsAlone
    with transaction.atomic():
        before, key = person_facts(user), user.pk
        held = User(role=user.role, is_active=user.is_active, organisation_id=user.organisation_id, is_service=user.is_service)
        _withdraw_invitations(user, actor)
        user.delete()
        _refuse_without_administrator(held)
        _record_person(actor if actor.pk != key else None, key, before, None)


def set_installation_operator(*, user: User, is_operator: bool) -> None:
    """On the machine, by whoever has it; no page and no address of the API gives this."""
    with transaction.atomic():
        before = person_facts(user)
        user.is_installation_operator = is_operator
        user.save(update_fields=["is_installation_operator"])
        record_change(
            organisation=user.organisation, actor=None, action="changed", subject_type="user", subject_id=user.pk,
            before=before, after=person_facts(user),
        )  # fmt: skip


def person_facts(user: User) -> dict[str, Any]:
    """What the history says of an account; never its password."""
    names = ("username", "first_name", "last_name", "email", "role", "is_active", "is_installation_operator")
    facts = {name: getattr(user, name) for name in names} | {"organisation": user.organisation.name}
    return facts | ({"is_service": True} if user.is_service else {})


def _refuse_without_administrator(before: User | None) -> None:
    """After a change, in its transaction. Two that are made at once wait for each other here."""
    if before is None or not _administrates(before):
        return
    with connection.cursor() as cursor:
        cursor.execute("SELECT pg_advisory_xact_lock(%s)", [ADMINISTRATORS_LOCK])
    left = User.objects.filter(is_active=True, is_service=False)
    administrators = left.filter(role=Role.ADMINISTRATOR)
    own = before.organisation_id
    if not administrators.exists() or (left.filter(organisation=own).exists() and not administrators.filter(organisation=own).exists()):
        raise NoAdministratorLeft


def _administrates(user: User) -> bool:
    return user.role == Role.ADMINISTRATOR and user.is_active and not user.is_service


def _withdraw_invitations(user: User, actor: User) -> None:
    """Whoever loses the role, or access, has no link at hand that gives it back."""
    now = timezone.now()
    still_open = Invitation.objects.filter(invited_by=user, accepted_at=None, revoked_at=None, expires_at__gt=now)
    for invitation in still_open.select_for_update():
        invitation.revoked_at = now
        invitation.save(update_fields=["revoked_at"])
        record_change(
            organisation=invitation.organisation, actor=actor, action="revoked", subject_type="invitation", subject_id=invitation.pk,
            before={"role": invitation.role, "email": invitation.email},
        )  # fmt: skip


def _record_person(actor: User | None, key: int, before: dict[str, Any] | None, after: dict[str, Any] | None) -> None:
    if before == after:
        return
    organisation_id = actor.organisation_id if actor else DEFAULT_ORGANISATION_ID
    action = "changed" if before and after else "created" if after else "deleted"
    AuditEntry.objects.create(
        organisation_id=organisation_id, actor=actor, action=action, subject_type="user", subject_id=str(key), before=before, after=after
    )
