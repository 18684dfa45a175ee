"""The steps of a file from upload to map data: proposed, read, reviewed, applied or discarded. Each kind of data has its own module."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import datetime
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import Any

from django.db import transaction
from django.utils import timezone
from django.utils.dateparse import parse_datetime

from inspection.auto_apply_hooks import AutoApplyRefusal, further_reasons, ground_mark
from inspection.importers.foreign_formats import foreign_format
from inspection.models import (
    MAX_REMOVED_PERCENT,
    DataImport,
    ImportKind,
    ImportProposal,
    ProposalOrigin,
    ProposalState,
    ProposedChange,
    Upload,
)
from inspection.selectors import ground_revision
from inspection.services.ground import hold_ground
from inspection.services.imports.overpass import fetch_area
from inspection.services.imports.regions import put_into_region
from inspection.services.imports.uploads import UploadRefused, upload_as_file
from inspection.services.proposals import assets, osm, terrain, zones
from inspection.services.proposals.reading import Change, Fault, FileKind, FileRefused, Progress, Provenance, Reading, reasons_against
from operation.reasons import Reason, english, reason_of, reasons_of
from workspace.jobs.services import cancel_job, create_job, finish_job, message_of
from workspace.models import DEFAULT_ORGANISATION_ID, Job, Organisation, User
from workspace.reason_texts import message_json

FILE_KINDS: dict[str, FileKind] = {ImportKind.OSM: osm, ImportKind.ZONES: zones, ImportKind.ASSETS: assets, ImportKind.TERRAIN: terrain}
READ_TASK = "inspection.tasks.read_proposal"
APPLY_TASK = "inspection.tasks.apply_proposal"
MAX_CHANGES_KEPT = 2_000  # of each action; users review a sample, and the totals cover all
MAX_FAULTS_KEPT = 50
READ = Reason("file_read")
DECISIONS = {"replace_edited", "seen", "excluded", "region"}  # parameters of the applying user that do not affect the difference
_BATCH = 500


class WrongState(Exception):
    """Raised when the proposal's state does not permit this; another user may have been faster."""

    def __init__(self, proposal: ImportProposal) -> None:
        super().__init__(f"The proposal is {proposal.get_state_display().lower()}.")
        self.proposal = proposal


class NotSeen(Exception):
    """Raised when unreadable records of the file are not acknowledged; `places` are theirs in the file."""

    def __init__(self, places: list[str]) -> None:
        super().__init__(f"{len(places)} records of the file are not read. See each of them first.")
        self.places = places


def start_proposal(
    *,
    kind: str,
    upload: Upload | None,
    file_name: str,
    parameters: dict[str, Any],
    provenance: dict[str, Any],
    created_by: User | None,
    origin: str = ProposalOrigin.UPLOAD,
    auto_apply: bool = False,
    max_removed_percent: float = MAX_REMOVED_PERCENT,
) -> ImportProposal:
    """Create a proposal and the job that reads it; the caller sends the job to its queue after the commit.

    With auto_apply it is applied once it is read, if it is within the bounds (bounds.py) and no later app objects (auto_apply_hooks.py);
    otherwise it waits for review, and `held_back` has the reasons.
    """
    with transaction.atomic():
        proposal = ImportProposal.objects.create(
            kind=kind,
            origin=origin,
            upload=upload,
            file_name=file_name[:255],
            parameters=parameters,
            provenance=provenance,
            created_by=created_by,
            auto_apply=auto_apply,
            max_removed_percent=max_removed_percent,
        )
        _give_job(proposal, READ_TASK, created_by, Reason("waiting_to_be_read"))
    return proposal


def read_again(*, proposal: ImportProposal, parameters: dict[str, Any], actor: User) -> ImportProposal:
    """Read the file with other parameters. Raises WrongState."""
    with _held(proposal, {ProposalState.READY, ProposalState.REFUSED}) as held:
        held.parameters = held.parameters | parameters
        held.state = ProposalState.READING
        held.faults, held.summary, held.difference, held.held_back = [], {}, {}, []
        held.changes.all().delete()
        _give_job(held, READ_TASK, actor, Reason("waiting_to_be_read"))
    return held


def ask_to_apply(*, proposal: ImportProposal, parameters: dict[str, Any], actor: User) -> ImportProposal:
    """Apply a reviewed difference; `seen` names the places of unreadable records. Raises WrongState, NotSeen.

    The difference was computed with the proposal's parameters: with other ones it is computed again first.
    """
    with _held(proposal, {ProposalState.READY}) as held:
        seen = parameters.get("seen")
        unseen = [
            record["place"] for record in held.summary.get("not_read", ()) if not isinstance(seen, list) or record["place"] not in seen
        ]
        if unseen:
            raise NotSeen(unseen)
        if any(held.parameters.get(name) != value for name, value in parameters.items() if name not in DECISIONS):
            held.ground_revision = None
        held.parameters = held.parameters | {"excluded": []} | parameters  # an earlier choice is not applied unseen
        held.state = ProposalState.APPLYING
        held.decided_by, held.decided_at = actor, timezone.now()
        _give_job(held, APPLY_TASK, actor, Reason("waiting_to_be_applied"))
    return held


def discard_proposal(*, proposal: ImportProposal, actor: User | None) -> ImportProposal:
    """Discard a proposal, and stop reading it. Raises WrongState."""
    with _held(proposal, {ProposalState.READING, ProposalState.READY, ProposalState.REFUSED}) as held:
        if held.job is not None and held.job.is_open:
            cancel_job(job=held.job)
        held.state = ProposalState.DISCARDED
        held.decided_by, held.decided_at = actor, timezone.now()
        held.save()
        held.changes.all().delete()
    return held


def size_mib_of(*, job: Job) -> float:
    """Return the size of the file of the job's proposal [MiB]; 0 without a file."""
    proposal = ImportProposal.objects.select_related("upload").filter(pk=job.parameters["proposal"]).first()
    return 0.0 if proposal is None or proposal.upload is None else proposal.upload.size_bytes / 1024**2


def read_proposal(*, job: Job, progress: Progress) -> Job | None:
    """Read the file and store its changes. A file with faults makes a refused proposal, not a failed job.

    Returns the job that applies it automatically, if any; the caller sends it to its queue.
    """
    proposal = ImportProposal.objects.select_related("upload").get(pk=job.parameters["proposal"])
    if proposal.job_id != job.pk or proposal.state != ProposalState.READING:
        return None
    revision = ground_revision()
    try:
        if proposal.origin == ProposalOrigin.OVERPASS and proposal.upload is None:
            _fetch(proposal, progress)
        reading = _with_file(proposal, lambda path, provenance: _module(proposal).read(
            path=path, parameters=proposal.parameters, provenance=provenance, progress=progress
        ))  # fmt: skip
        with transaction.atomic():
            _store_reading(proposal, job, reading, revision)
            return _go_on_by_itself(proposal, job) if proposal.auto_apply else None
    except FileRefused as error:
        refuse_proposal(proposal=proposal, faults=error.faults, job=job, are_of_records=error.are_of_records)
    return None


def _go_on_by_itself(proposal: ImportProposal, job: Job) -> Job | None:
    """Start applying a proposal that is within its bounds; whether flights are affected is checked when it is written."""
    held = ImportProposal.objects.select_for_update(of=["self"]).get(pk=proposal.pk)
    if held.state != ProposalState.READY:
        return None
    reasons = reasons_against(held.difference, held.summary, held.max_removed_percent)
    if reasons:
        _hold_back(held, reasons)
        return None
    held.state = ProposalState.APPLYING
    held.decided_by, held.decided_at = job.created_by, timezone.now()
    _give_job(held, APPLY_TASK, job.created_by, Reason("waiting_to_be_applied"), by_itself=True)
    return held.job


def _hold_back(proposal: ImportProposal, reasons: list[AutoApplyRefusal]) -> None:
    ImportProposal.objects.filter(pk=proposal.pk, state__in=(ProposalState.READY, ProposalState.APPLYING)).update(
        state=ProposalState.READY, decided_by=None, decided_at=None,
        held_back=[{"code": reason.code, **message_json(reason.why)} for reason in reasons],
    )  # fmt: skip


def _fetch(proposal: ImportProposal, progress: Progress) -> None:
    """Fetch the data and store them, so that reading again gives the same."""
    upload, provenance = fetch_area(parameters=proposal.parameters, created_by=proposal.created_by, progress=progress)
    proposal.upload, proposal.provenance, proposal.file_name = upload, provenance, upload.file_name
    proposal.save(update_fields=["upload", "provenance", "file_name"])


def apply_proposal(*, job: Job, progress: Progress) -> None:
    """Update the map data to the file: the rows, the import, the proposal's state and the job's end in one transaction.

    If the difference has changed since the review, nothing is applied, and the new difference waits for review. An automatic one is
    compared with its bounds as it is written, and rolled back if it exceeds them.
    """
    proposal = ImportProposal.objects.select_related("upload", "decided_by").get(pk=job.parameters["proposal"])
    if proposal.job_id != job.pk or proposal.state != ProposalState.APPLYING:
        return
    try:
        if job.parameters.get("by_itself"):
            _with_file(proposal, partial(_apply_by_itself, proposal, job, progress))
            return
        seen = proposal.ground_revision
        while True:
            revision = ground_revision()
            if revision != seen and _differs_now(proposal, job, revision, progress):
                return
            seen = revision
            try:
                _with_file(proposal, partial(_apply, proposal, job, seen, progress))
                return
            except _GroundMoved:
                continue
    except FileRefused as error:
        refuse_proposal(proposal=proposal, faults=error.faults, job=job)


def refuse_proposal(*, proposal: ImportProposal, faults: tuple[Fault, ...], job: Job | None = None, are_of_records: bool = False) -> None:
    """Mark a proposal as refused: the file has faults or is unreadable, and none of it counts."""
    listed = [
        {"place": fault.place, **message_json(fault.message), "position": list(fault.position) if fault.position else None}
        for fault in faults[:MAX_FAULTS_KEPT]
    ]
    with transaction.atomic():
        if job is not None and not finish_job(job=job, message=Reason("file_refused")):
            raise LostJob
        open_states = (ProposalState.READING, ProposalState.APPLYING)
        summary = {"can_leave_out": True} if are_of_records else {}
        ImportProposal.objects.filter(pk=proposal.pk, state__in=open_states).update(
            state=ProposalState.REFUSED, faults=listed, summary=summary
        )


def settle_proposal_of(*, job: Job) -> None:
    """Settle the proposal of a cancelled or failed job: reading ends discarded or refused, applying returns to review."""
    proposal = ImportProposal.objects.filter(job=job).first()
    if proposal is None:
        return
    job.refresh_from_db()
    if proposal.state == ProposalState.APPLYING:
        if job.parameters.get("by_itself"):
            _hold_back(proposal, [AutoApplyRefusal("not_applied", message_of(job))])
            return
        ImportProposal.objects.filter(pk=proposal.pk, state=ProposalState.APPLYING).update(
            state=ProposalState.READY, decided_by=None, decided_at=None
        )
    elif proposal.state == ProposalState.READING and job.state == "failed":
        refuse_proposal(proposal=proposal, faults=(Fault("", _failure_of(job)),))
    elif proposal.state == ProposalState.READING and job.state == "cancelled":
        ImportProposal.objects.filter(pk=proposal.pk).update(state=ProposalState.DISCARDED, decided_at=timezone.now())


def _failure_of(job: Job) -> Reason | str:
    why = message_of(job) if job.error else Reason("file_not_read")
    return next(iter(reasons_of(why)), english(why))


def unsettled_proposals() -> list[ImportProposal]:
    """Return proposals whose job has ended without settling them, because its worker was lost."""
    ended = ("failed", "cancelled")
    return list(
        ImportProposal.objects.select_related("job").filter(state__in=(ProposalState.READING, ProposalState.APPLYING), job__state__in=ended)
    )


class LostJob(Exception):
    """Raised when another worker has taken the job over; this one's writes are rolled back."""


class _GroundMoved(Exception):
    """Raised when the map data changed between the review and the lock."""


def _apply(proposal: ImportProposal, job: Job, revision: int | None, progress: Progress, path: Path | None, provenance: Provenance) -> None:
    with transaction.atomic():
        hold_ground()
        if ground_revision() != revision:
            raise _GroundMoved
        data_import: DataImport = _module(proposal).apply(
            path=path, parameters=proposal.parameters, provenance=provenance, applied_by=proposal.decided_by, progress=progress
        )
        _choose_region(proposal, data_import)
        if not finish_job(job=job, result={"data_import": data_import.pk}, message=Reason("file_applied")):
            raise LostJob
        ImportProposal.objects.filter(pk=proposal.pk).update(state=ProposalState.APPLIED, data_import=data_import)


def _choose_region(proposal: ImportProposal, data_import: DataImport) -> None:
    """Move the import to the region that its user named; without one it stays where it belongs by its place."""
    if name := str(proposal.parameters.get("region") or "").strip():
        put_into_region(data_import, name)


class _TakenBack(Exception):
    """Raised when the written changes exceed the bounds; their transaction is rolled back."""

    def __init__(self, reasons: list[AutoApplyRefusal]) -> None:
        super().__init__(f"{len(reasons)} reasons")
        self.reasons = reasons


def _apply_by_itself(proposal: ImportProposal, job: Job, progress: Progress, path: Path | None, provenance: Provenance) -> None:
    """Write the changes, and check all of them in the tables: the stored difference has only the first ones."""
    try:
        with transaction.atomic():
            hold_ground()
            mark = ground_mark()
            data_import: DataImport = _module(proposal).apply(
                path=path, parameters=proposal.parameters, provenance=provenance, applied_by=proposal.decided_by, progress=progress
            )
            _choose_region(proposal, data_import)
            counts = data_import.counts  # of this run
            reasons = reasons_against(counts, counts, proposal.max_removed_percent)
            if any(counts[action] for action in ("new", "changed", "vanished")):
                reasons += further_reasons(mark, data_import)
            if reasons:
                raise _TakenBack(reasons)
            if not finish_job(job=job, result={"data_import": data_import.pk}, message=Reason("file_applied")):
                raise LostJob
            ImportProposal.objects.filter(pk=proposal.pk).update(state=ProposalState.APPLIED, data_import=data_import)
    except _TakenBack as taken_back:
        with transaction.atomic():
            if not finish_job(job=job, result={"proposal": str(proposal.pk)}, message=Reason("file_held_back")):
                raise LostJob from taken_back
            _hold_back(proposal, taken_back.reasons)


def _differs_now(proposal: ImportProposal, job: Job, revision: int, progress: Progress) -> bool:
    """Whether the file's changes differ from the reviewed ones; the new difference is then stored."""
    reading: Reading = _with_file(proposal, lambda path, provenance: _module(proposal).read(
        path=path, parameters=proposal.parameters, provenance=provenance, progress=progress
    ))  # fmt: skip
    reading.changes = tuple(reading.changes)
    if reading.numbers == proposal.difference and _fingerprints(reading.changes) == _stored_fingerprints(proposal):
        return False
    _store_reading(proposal, job, reading, revision, message=Reason("ground_has_changed"))
    return True


def _fingerprints(changes: tuple[Change, ...]) -> list[tuple[Any, ...]]:
    return sorted(_fingerprint(_row(None, change)) for change in _first_of_each(changes))


def _stored_fingerprints(proposal: ImportProposal) -> list[tuple[Any, ...]]:
    return sorted(_fingerprint(row) for row in proposal.changes.all())


def _fingerprint(row: ProposedChange) -> tuple[Any, ...]:
    facts = [json.dumps(value, sort_keys=True) for value in (row.before, row.after)]
    return (row.action, row.subject, row.subject_id or 0, row.label, *facts)


def _store_reading(proposal: ImportProposal, job: Job, reading: Reading, revision: int, message: Reason = READ) -> None:
    with transaction.atomic():
        proposal.changes.all().delete()
        rows = [_row(proposal, change) for change in _first_of_each(tuple(reading.changes))]
        ProposedChange.objects.bulk_create(rows, batch_size=_BATCH)
        if not finish_job(job=job, result={"proposal": str(proposal.pk)}, message=message):
            raise LostJob
        ImportProposal.objects.filter(pk=proposal.pk, state__in=(ProposalState.READING, ProposalState.APPLYING)).update(
            state=ProposalState.READY, summary=reading.summary, difference=reading.numbers, ground_revision=revision, faults=[],
            decided_by=None, decided_at=None,
        )  # fmt: skip


def _first_of_each(changes: tuple[Change, ...]) -> list[Change]:
    ordered = sorted(changes, key=lambda change: change.action)
    return [change for _, group in groupby(ordered, key=lambda change: change.action) for change in list(group)[:MAX_CHANGES_KEPT]]


def _row(proposal: ImportProposal | None, change: Change) -> ProposedChange:
    return ProposedChange(
        proposal=proposal, action=change.action, subject=change.subject, subject_id=change.subject_id, label=change.label[:300],
        key=change.key[:300], geometry=change.geometry, before=change.before, after=change.after,
    )  # fmt: skip


def _with_file(proposal: ImportProposal, do: Callable[[Path | None, Provenance], Any]) -> Any:
    provenance = _provenance(proposal)
    if proposal.upload is None:
        if proposal.origin != ProposalOrigin.ROLL_BACK:
            raise FileRefused([Fault("", Reason("file_not_kept"))])
        return do(None, provenance)
    try:
        with upload_as_file(proposal.upload) as path:
            if foreign := foreign_format(path):
                raise FileRefused([Fault("", Reason("other_format", {"format": foreign}))])
            return do(path, replace(provenance, file_name=proposal.file_name))
    except UploadRefused as error:
        raise FileRefused([Fault("", reason_of(error))]) from error


def _provenance(proposal: ImportProposal) -> Provenance:
    stated = proposal.provenance
    fetched: datetime | None = parse_datetime(stated["fetched_at"]) if stated.get("fetched_at") else None
    return Provenance(
        file_name=proposal.file_name, source_address=stated.get("source_address", ""), licence=stated.get("licence", ""),
        attribution=stated.get("attribution", ""), fetched_at=fetched,
        organisation_id=proposal.organisation_id,
    )  # fmt: skip


def _module(proposal: ImportProposal) -> FileKind:
    return FILE_KINDS[proposal.kind]


def _give_job(proposal: ImportProposal, task: str, actor: User | None, message: Reason, *, by_itself: bool = False) -> None:
    organisation = actor.organisation if actor else Organisation.objects.get(pk=DEFAULT_ORGANISATION_ID)
    parameters: dict[str, Any] = {"proposal": str(proposal.pk)} | ({"by_itself": True} if by_itself else {})
    proposal.job = create_job(organisation=organisation, created_by=actor, task=task, parameters=parameters, message=message)
    proposal.save()


@contextmanager
def _held(proposal: ImportProposal, states: set[ProposalState]) -> Iterator[ImportProposal]:
    """Yield the locked proposal in a transaction, if it is in one of the states. Raises WrongState."""
    with transaction.atomic():
        held = ImportProposal.objects.select_for_update(of=["self"]).select_related("job", "decided_by").get(pk=proposal.pk)
        if held.state not in states:
            raise WrongState(held)
        yield held
