"""Changes of findings. Every change is in the history; a finding that is done is verified by a later photo alone."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import date, datetime, timedelta
from typing import Any

from django.db import transaction
from django.db.models import Max
from django.utils import timezone
from django.utils.translation import gettext as _

from inspection.models import Asset
from inspection.selectors import asset_label
from missions.models import InspectionTarget, Mission
from results.categories import BY_CODE, SCHEME
from results.finding_states import FindingState, after_observation, may_set
from results.models import Evidence, Finding, FindingComment, Medium, MediumState, Observation, ObservationOutcome, Review, SeveritySource
from results.models.findings import MAX_MARKS
from results.services.media import review_medium
from workspace.audit import record_change
from workspace.leases import lock_until_end
from workspace.models import User

NUMBERS_LOCK = 0x05A7_0036  # advisory lock, with the organisation
DUE_DAYS = {1: 0, 2: 180, 3: 1_095}  # by severity, after CPUC General Order 95, Rule 18; 4 needs no action
FACTS = ("category", "severity", "severity_source", "note", "state", "work_reference", "asset_id", "target_id")


class FindingRefused(ValueError):
    """Raised for a change that contradicts the finding; the message has the reason."""

    def __init__(self, field: str, message: str) -> None:
        self.field = field
        super().__init__(message)


class FindingChanged(Exception):
    """Raised when the finding is another one than the user has seen."""


@dataclass(frozen=True)
class Mark:
    """A place on a medium; shape None: all of it."""

    medium: Medium
    shape: dict[str, Any] | None = None


def create_finding(
    *,
    actor: User,
    category: str,
    severity: int,
    marks: Sequence[Mark] = (),
    note: str = "",
    asset: Asset | None = None,
    target: InspectionTarget | None = None,
    mission: Mission | None = None,
    due_on: date | None = None,
    work_reference: str = "",
) -> Finding:
    """Create a finding. What it does not state, its first medium does. Raises FindingRefused."""
    _check_note(category, note)
    first = marks[0].medium if marks else None
    if first is not None:
        mission, target = mission or first.mission, target or first.target
        asset = asset or first.asset
    asset = asset or (target.asset if target is not None else None)
    seen_at = [mark.medium.taken_at or mark.medium.received_at for mark in marks] or [timezone.now()]
    with transaction.atomic():
        lock_until_end(NUMBERS_LOCK, actor.organisation_id)
        last = Finding.objects.filter(organisation=actor.organisation_id).aggregate(last=Max("number"))["last"] or 0
        finding = Finding.objects.create(
            organisation_id=actor.organisation_id, number=last + 1, asset=asset, asset_label="" if asset is None else asset_label(asset),
            mission=mission, target=target, position=_position_of(asset, target, first), category=category, scheme=SCHEME, note=note,
            severity=severity, severity_source=SeveritySource.USER, due_on=due_on or _due_on(severity, timezone.now()),
            work_reference=work_reference, first_seen_at=min(seen_at), last_seen_at=max(seen_at), created_by=actor,
        )  # fmt: skip
        for mark in marks:
            _add_mark(finding, mark, actor)
        _record(finding, actor, "create", None)
    return finding


def change_finding(*, finding: Finding, actor: User, values: Mapping[str, Any], expected_revision: int | None) -> Finding:
    """Change fields of a finding. Raises FindingChanged or FindingRefused."""
    with transaction.atomic():
        held = _locked(finding, expected_revision)
        before = facts_of(held)
        if "state" in values:
            _set_state(held, FindingState(values["state"]))
        if "severity" in values and values["severity"] != held.severity:
            held.severity, held.severity_source = values["severity"], SeveritySource.USER
            if "due_on" not in values:
                held.due_on = _due_on(held.severity, held.created_at)
        for name in ("category", "note", "work_reference", "due_on"):
            if name in values:
                setattr(held, name, values[name])
        if "category" in values:
            held.scheme = SCHEME
        if "asset" in values:
            held.asset = values["asset"]
            held.asset_label = "" if held.asset is None else asset_label(held.asset)
            held.position = held.asset.centre if held.asset is not None else held.position
        if {"category", "note"} & set(values):
            _check_note(held.category, held.note)
        _store(held)
        _record(held, actor, "change", before)
    return held


def add_evidence(*, finding: Finding, actor: User, mark: Mark) -> Finding:
    """Add a mark on a medium, which shows the finding."""
    with transaction.atomic():
        held = _locked(finding, None)
        before = facts_of(held)
        if held.evidence.count() >= MAX_MARKS:
            raise FindingRefused("evidence", _("A finding has at most %(most)s marks.") % {"most": MAX_MARKS})
        _add_mark(held, mark, actor)
        at = min(mark.medium.taken_at or mark.medium.received_at, timezone.now())
        held.first_seen_at, held.last_seen_at = min(held.first_seen_at, at), max(held.last_seen_at, at)
        _store(held)
        _record(held, actor, "add-evidence", before)
    return held


def remove_evidence(*, evidence: Evidence, actor: User) -> Finding:
    """Remove a mark, such as one at a wrong place. The medium stays."""
    with transaction.atomic():
        held = _locked(evidence.finding, None)
        before = facts_of(held)
        medium = evidence.medium
        evidence.delete()
        if not Evidence.objects.filter(medium=medium).exists() and medium.review == Review.FINDINGS:
            review_medium(medium=medium, actor=actor, review="")
        _store(held)
        _record(held, actor, "remove-evidence", before)
    return held


def observe_finding(*, finding: Finding, actor: User, medium: Medium, outcome: str) -> Finding:
    """Store that a user has looked for a finding on a later medium, and move its state on. Raises FindingRefused."""
    if medium.state == MediumState.WAITING:
        raise FindingRefused("medium", _("The photo has not been read yet. Try again in a minute."))
    at = medium.taken_at
    if at is None or at > timezone.now() + timedelta(days=1):
        raise FindingRefused("medium", _("The time of this photo is unknown, so it cannot show a later state."))
    with transaction.atomic():
        held = _locked(finding, None)
        before = facts_of(held)
        if held.asset_id is None or medium.asset_id != held.asset_id:
            raise FindingRefused("medium", _("The photo is not of the finding's asset."))
        if at <= held.last_seen_at:
            raise FindingRefused("medium", _("The photo is not later than the last one that shows the finding."))
        if outcome == ObservationOutcome.NOT_SEEN and held.state == FindingState.DONE and held.done_at is not None and at <= held.done_at:
            raise FindingRefused("medium", _("The photo was taken before the work was done."))
        Observation.objects.create(finding=held, medium=medium, outcome=outcome, observed_at=at, author=actor)
        is_seen = outcome == ObservationOutcome.SEEN
        held.state = after_observation(FindingState(held.state), is_seen=is_seen).value
        if is_seen:
            held.last_seen_at = at
        _store(held)
        _record(held, actor, "observe", before)
    return held


def comment_finding(*, finding: Finding, actor: User, text: str) -> FindingComment:
    return FindingComment.objects.create(finding=finding, author=actor, text=text)


def facts_of(finding: Finding) -> dict[str, Any]:
    """Return what the history keeps of a finding."""
    return {name: getattr(finding, name) for name in FACTS} | {
        "due_on": None if finding.due_on is None else finding.due_on.isoformat(),
        "evidence": list(finding.evidence.order_by("pk").values_list("pk", flat=True)),
        "observations": finding.observations.count(),
    }


def _locked(finding: Finding, expected_revision: int | None) -> Finding:
    held = Finding.objects.select_for_update(of=["self"]).get(pk=finding.pk)
    if expected_revision is not None and held.revision != expected_revision:
        raise FindingChanged
    return held


def _store(finding: Finding) -> None:
    finding.revision += 1
    finding.save()


def _record(finding: Finding, actor: User, action: str, before: dict[str, Any] | None) -> None:
    record_change(
        organisation=finding.organisation, actor=actor, action=action, subject_type="finding", subject_id=finding.pk, before=before,
        after=facts_of(finding),
    )  # fmt: skip


def _set_state(finding: Finding, state: FindingState) -> None:
    present = FindingState(finding.state)
    if state == FindingState.VERIFIED and present != state:
        raise FindingRefused("state", _("Only a later photo that does not show the finding verifies it: add an observation."))
    if not may_set(present, state):
        raise FindingRefused("state", _("This state cannot follow the present one."))
    if state != present:
        finding.done_at = timezone.now() if state == FindingState.DONE else None
    finding.state = state.value


def _add_mark(finding: Finding, mark: Mark, actor: User) -> None:
    _check_shape(mark)
    Evidence.objects.create(finding=finding, medium=mark.medium, shape=mark.shape, author=actor)
    if mark.medium.review != Review.FINDINGS:
        review_medium(medium=mark.medium, actor=actor, review=Review.FINDINGS)


def _check_shape(mark: Mark) -> None:
    """Raise FindingRefused for a shape outside of the picture."""
    if mark.shape is None:
        return
    if mark.medium.width_px is None or mark.medium.height_px is None:
        raise FindingRefused("evidence", _("The size of this file is not known: it takes no marks."))
    for x, y in _corners(mark.shape):
        if not (0.0 <= x <= mark.medium.width_px and 0.0 <= y <= mark.medium.height_px):
            raise FindingRefused(
                "evidence",
                _("The mark is outside of the picture, which has %(width)s × %(height)s pixels.")
                % {"width": mark.medium.width_px, "height": mark.medium.height_px},
            )


def _corners(shape: Mapping[str, Any]) -> list[tuple[float, float]]:
    if shape["type"] == "box":
        return [(shape["x"], shape["y"]), (shape["x"] + shape["width"], shape["y"] + shape["height"])]
    return [(x, y) for x, y in shape["points"]]


def _check_note(category: str, note: str) -> None:
    if BY_CODE[category].needs_note and not note.strip():
        raise FindingRefused("note", _("This category says nothing without a note."))


def _due_on(severity: int, since: datetime) -> date | None:
    days = DUE_DAYS.get(severity)
    return None if days is None else (since + timedelta(days=days)).date()


def _position_of(asset: Asset | None, target: InspectionTarget | None, medium: Medium | None) -> Any:
    if asset is not None:
        return asset.centre
    if target is not None and target.position is not None:
        return target.position
    return None if medium is None else medium.position
