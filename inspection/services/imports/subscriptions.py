"""Subscriptions of zone sets: schedule, source, and the proposal made of a response, which a curator decides on."""

import tempfile
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from django.conf import settings
from django.db import IntegrityError, transaction
from django.utils import timezone
from django.utils.translation import gettext as _

from inspection.importers.zones.zone_file import MAX_FILE_BYTES, ZoneFileError
from inspection.models import ImportKind, ImportProposal, ProposalOrigin, ProposalState, ZoneSet, ZoneSubscription
from inspection.selectors.zone_sets import FETCH_TASK, open_fetch_of
from inspection.services.imports.uploads import plain_name, store_upload, upload_folder
from inspection.services.imports.zone_sets import difference_of
from inspection.services.imports.zones import read_zone_file, stated_validity
from inspection.services.proposals.pipeline import LostJob, WrongState, discard_proposal, start_proposal
from inspection.services.proposals.reading import Progress
from operation.reasons import Reason
from workspace.audit import record_change
from workspace.http_client import Fetched, OutgoingError, OutgoingFailed, fetch
from workspace.jobs.services import create_job, fail_job, finish_job
from workspace.models import DEFAULT_ORGANISATION_ID, Job, Organisation, User

SILENCE_S = 20.0
TOTAL_S = 120.0
FIRST_RETRY = timedelta(minutes=15)  # doubled with each further failure
MAX_RETRY_DELAY = timedelta(days=1)  # or the interval, if that is longer
MAX_CONCURRENT = 20  # fetches started at once
_FOLDER_PREFIX = "spanwise-upload-"  # leftovers of a killed worker are removed with the uploads
_CHANGEABLE = ("address", "source_format", "licence", "attribution", "interval_h", "is_active")
_OPEN = (ProposalState.READING, ProposalState.READY, ProposalState.APPLYING)


class AlreadySubscribed(ValueError):
    """Raised when the set already has a subscription."""


def subscribe(*, set_name: str, actor: User, **values: Any) -> ZoneSubscription:
    """Subscribe a set, which is created if missing; the first fetch is at the next run of the schedule. Raises AlreadySubscribed."""
    try:
        with transaction.atomic():
            zone_set, _is_new = ZoneSet.objects.get_or_create(name=set_name)
            subscription = ZoneSubscription.objects.create(zone_set=zone_set, next_fetch_at=timezone.now(), **values)
            _record(actor, subscription, "created", None, _facts(subscription))
    except IntegrityError as error:
        raise AlreadySubscribed(
            _("The set %(set_name)s is fetched already. Change its subscription instead.") % {"set_name": set_name}
        ) from error
    return subscription


def change_subscription(*, subscription: ZoneSubscription, actor: User, **values: Any) -> ZoneSubscription:
    """Change a subscription. A new address resets what is known of the source; a resumed subscription is fetched soon."""
    with transaction.atomic():
        held = ZoneSubscription.objects.select_for_update(of=["self"]).select_related("zone_set").get(pk=subscription.pk)
        before = _facts(held)
        for name, value in values.items():
            setattr(held, name, value)
        after = _facts(held)
        if after == before:
            return held
        now = timezone.now()
        if held.address != before["address"] or held.source_format != before["source_format"]:
            held.etag = held.last_modified = held.sha256 = held.problem = ""
            held.failures, held.fetched_at, held.next_fetch_at = 0, None, now
        elif held.is_active and not before["is_active"]:
            held.next_fetch_at = now
        elif held.failures == 0 and held.fetched_at is not None:
            held.next_fetch_at = held.fetched_at + timedelta(hours=held.interval_h)
        held.save()
        _record(actor, held, "changed", before, after)
    return held


def unsubscribe(*, subscription: ZoneSubscription, actor: User) -> None:
    """Remove the subscription. The set with its zones, and undecided proposals, stay."""
    with transaction.atomic():
        _record(actor, subscription, "deleted", _facts(subscription), None)
        subscription.delete()


def ask_to_fetch(*, subscription: ZoneSubscription, actor: User) -> Job:
    """Return a job that fetches now, or the one that already does; the caller sends it to its queue after the commit."""
    with transaction.atomic():
        held = ZoneSubscription.objects.select_for_update(of=["self"]).get(pk=subscription.pk)
        if job := open_fetch_of(held):
            return job
        _put_off(held)
        return _fetch_job(held, actor)


def start_due_fetches() -> list[Job]:
    """Return jobs for the due subscriptions. Concurrent runs start none twice: rows are locked, and rescheduled before the fetch."""
    jobs = []
    with transaction.atomic():
        due = ZoneSubscription.objects.select_for_update(skip_locked=True, of=["self"]).filter(
            is_active=True, next_fetch_at__lte=timezone.now()
        )
        for subscription in due.order_by("next_fetch_at")[:MAX_CONCURRENT]:
            _put_off(subscription)
            if open_fetch_of(subscription) is None:
                jobs.append(_fetch_job(subscription, None))
    return jobs


def fetch_subscription(*, job: Job, progress: Progress) -> ImportProposal | None:
    """Fetch, and propose a new response; the caller sends the proposal's job to its queue.

    A scheduled fetch proposes a response once: one that a curator discarded or rolled back does not come back every day. A requested fetch
    proposes it again, unless it equals the set or is still undecided.
    """
    subscription = ZoneSubscription.objects.select_related("zone_set", "proposal").filter(pk=job.parameters["subscription"]).first()
    if subscription is None:
        finish_job(job=job, message=Reason("subscription_gone"))
        return None
    is_asked_for = job.created_by_id is not None
    most_bytes = min(MAX_FILE_BYTES, settings.MAX_UPLOAD_BYTES[ImportKind.ZONES])
    with tempfile.TemporaryDirectory(prefix=_FOLDER_PREFIX, dir=upload_folder()) as folder:
        path = Path(folder) / _file_name(subscription)
        progress(Reason("fetching"), 0.0)
        try:
            fetched = fetch(
                subscription.address, to=path, max_bytes=most_bytes, timeout_s=SILENCE_S, total_s=TOTAL_S,
                headers={} if is_asked_for else _conditions(subscription),
                progress=lambda size: progress(Reason("fetching"), 0.9 * size / most_bytes),
            )  # fmt: skip
        except OutgoingError as error:
            _note_failure(subscription, job, error)
            return None
        progress(Reason("comparing_answer"), 0.9)
        is_news = _is_news(subscription, fetched, path, is_asked_for=is_asked_for)
        return _note_answer(subscription, job, fetched, path if is_news else None)


def _is_news(subscription: ZoneSubscription, fetched: Fetched, path: Path, *, is_asked_for: bool) -> bool:
    if fetched.status == 304:
        return False
    is_as_before = fetched.sha256 == subscription.sha256
    if is_as_before and (not is_asked_for or (subscription.proposal is not None and subscription.proposal.state in _OPEN)):
        return False
    return not _says_what_the_set_says(subscription.zone_set, path)


def _says_what_the_set_says(zone_set: ZoneSet, path: Path) -> bool:
    """Whether the file equals the set even if its bytes differ: many sources write the time of the request into each response."""
    try:
        content, _digest = read_zone_file(path)
    except ZoneFileError:
        return False  # the proposal reports the faults
    known = zone_set.data_import
    if known is None or stated_validity(content) != (known.valid_from, known.valid_until):
        return False
    return not difference_of(zone_set, content.zones).changes_something


def _note_answer(subscription: ZoneSubscription, job: Job, fetched: Fetched, path: Path | None) -> ImportProposal | None:
    """Store the source's response, and propose the file if it is new. Does nothing if the address was changed meanwhile."""
    with transaction.atomic():
        held = _held(subscription)
        proposal = None
        if held is not None:
            if path is not None:
                proposal = _propose(held, job, fetched, path)
            elif fetched.status == 200 and fetched.sha256 != held.sha256:
                _discard_undecided(held)  # the source equals the set again
            held.fetched_at, held.problem, held.failures = timezone.now(), "", 0
            if fetched.status == 200:
                held.etag, held.last_modified, held.sha256 = fetched.etag, fetched.last_modified, fetched.sha256
            held.next_fetch_at = max(held.next_fetch_at, _next_regular(held))
            held.save()
        message = Reason("new_file_proposed" if proposal else "nothing_new" if held else "subscription_changed")
        result = {"proposal": str(proposal.pk) if proposal else None, "is_new": proposal is not None}
        if not finish_job(job=job, result=result, message=message):
            raise LostJob
    return proposal


def _propose(held: ZoneSubscription, job: Job, fetched: Fetched, path: Path) -> ImportProposal:
    _discard_undecided(held)
    with path.open("rb") as file:
        upload = store_upload(file_name=path.name, chunks=iter(lambda: file.read(1024 * 1024), b""), created_by=None)
    parameters = {"set_name": held.zone_set.name} | ({"format": held.source_format} if held.source_format else {})
    held.proposal = start_proposal(
        kind=ImportKind.ZONES, origin=ProposalOrigin.SUBSCRIPTION, upload=upload, file_name=upload.file_name, parameters=parameters,
        provenance={
            "source_address": held.address, "licence": held.licence, "attribution": held.attribution,
            "fetched_at": timezone.now().isoformat(),
        },
        created_by=job.created_by,
    )  # fmt: skip
    return held.proposal


def _discard_undecided(held: ZoneSubscription) -> None:
    """Discard an undecided proposal in favour of a newer response. One that is being applied has been decided on."""
    if held.proposal is None or held.proposal.state not in {ProposalState.READING, ProposalState.READY, ProposalState.REFUSED}:
        return
    try:
        discard_proposal(proposal=held.proposal, actor=None)
    except WrongState:
        return


def _note_failure(subscription: ZoneSubscription, job: Job, error: OutgoingError) -> None:
    with transaction.atomic():
        held = _held(subscription)
        if held is not None:
            held.failures = min(held.failures + 1, 1_000)
            held.problem = str(error)[:500]
            wait = min(FIRST_RETRY * 2 ** min(held.failures - 1, 20), max(MAX_RETRY_DELAY, timedelta(hours=held.interval_h)))
            if isinstance(error, OutgoingFailed) and error.retry_after_s is not None:
                wait = max(wait, timedelta(seconds=error.retry_after_s))
            held.next_fetch_at = timezone.now() + wait
            held.save()
        fail_job(job=job, code="fetch_failed", message=str(error))


def _held(subscription: ZoneSubscription) -> ZoneSubscription | None:
    """Return the locked row; None if it was deleted or its address changed."""
    rows = ZoneSubscription.objects.select_for_update(of=["self"]).select_related("zone_set", "proposal")
    return rows.filter(pk=subscription.pk, address=subscription.address).first()


def _conditions(subscription: ZoneSubscription) -> dict[str, str]:
    """Return the headers that let the source respond "not modified"."""
    headers = {}
    if subscription.sha256 and subscription.etag:
        headers["If-None-Match"] = subscription.etag
    if subscription.sha256 and subscription.last_modified:
        headers["If-Modified-Since"] = subscription.last_modified
    return headers


def _put_off(subscription: ZoneSubscription) -> None:
    subscription.next_fetch_at = _next_regular(subscription)
    subscription.save(update_fields=["next_fetch_at"])


def _next_regular(subscription: ZoneSubscription) -> datetime:
    return timezone.now() + timedelta(hours=subscription.interval_h)


def _fetch_job(subscription: ZoneSubscription, actor: User | None) -> Job:
    organisation = actor.organisation if actor else Organisation.objects.get(pk=DEFAULT_ORGANISATION_ID)
    parameters = {"subscription": subscription.pk}
    return create_job(
        organisation=organisation, created_by=actor, task=FETCH_TASK, parameters=parameters, message=Reason("waiting_to_be_fetched")
    )


def _file_name(subscription: ZoneSubscription) -> str:
    """Return the last part of the address, if it is a name."""
    name = plain_name(unquote(urlsplit(subscription.address).path).rstrip("/"))
    return plain_name(subscription.zone_set.name) if name == "file" else name


def _facts(subscription: ZoneSubscription) -> dict[str, Any]:
    return {name: getattr(subscription, name) for name in _CHANGEABLE}


def _record(actor: User, subscription: ZoneSubscription, action: str, before: dict[str, Any] | None, after: dict[str, Any] | None) -> None:
    record_change(
        organisation=actor.organisation, actor=actor, action=action, subject_type="zone_subscription", subject_id=subscription.pk,
        before=before, after=after,
    )  # fmt: skip
