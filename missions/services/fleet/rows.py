"""What every write to the fleet has in common: one lock, one revision, one entry in the history, and a way back after a deletion."""

from collections.abc import Callable
from typing import Any, TypeVar

from django.db import IntegrityError, transaction
from django.db.models import ProtectedError

from missions.models import Base, Uav, UavType
from missions.selectors.fleet import facts_when_deleted
from workspace.audit import record_change
from workspace.models import Organisation, User

SUBJECTS: dict[type, str] = {Uav: "uav", UavType: "uav_type", Base: "base"}
NAMES_TAKEN = {"uav_name_unique", "uav_type_name_unique", "base_name_unique"}

Row = TypeVar("Row", Uav, UavType, Base)
Facts = Callable[[Any], dict[str, Any]]


class NameTaken(Exception):
    """Another row of the same kind has this name; `subject` says which kind."""

    def __init__(self, subject: str = "uav") -> None:
        super().__init__(subject)
        self.subject = subject


class UavExternalIdTaken(Exception):
    """Another UAV of the organisation has this external id."""


class SystemIdTaken(Exception):
    """Another UAV has this MAVLink system id."""


class SystemIdQuota(Exception):
    """The organisation has as many MAVLink system ids as one may have."""

    def __init__(self, limit: int) -> None:
        super().__init__(str(limit))
        self.limit = limit


class FleetChanged(Exception):
    """Somebody else was faster: the row is not the one that the caller has seen."""

    def __init__(self, subject: str, key: int) -> None:
        super().__init__(f"{subject} {key}")
        self.subject = subject
        self.key = key


class FleetRowInUse(Exception):
    """Something points at the row: missions at a UAV, UAVs at a type or a base."""

    def __init__(self, subject: str, users: int) -> None:
        super().__init__(f"{subject}: {users}")
        self.subject = subject
        self.users = users


class NotDeleted(Exception):
    """There is nothing to bring back."""


def locked(row: Row, expected_revision: int | None) -> Row:
    """The row as it is now, held until the caller's transaction ends. Raises FleetChanged.

    Also against rows that come to point at it, as a UAV's records do all the time: a name or a system id is a key, and who changes one
    while he holds less than that, and a report of the UAV is being stored, is in its way, and it in his.
    """
    held = type(row)._default_manager.select_for_update().filter(pk=row.pk).first()
    if held is None or (expected_revision is not None and held.revision != expected_revision):
        raise FleetChanged(SUBJECTS[type(row)], row.pk)
    return held


def stored(row: Row, *, actor: User | None, action: str, before: dict[str, Any] | None, facts: Facts) -> Row:
    """Save a row that is new, changed or brought back, with its entry in the history.

    Raises NameTaken, ExternalIdTaken or SystemIdTaken.
    """
    try:
        with transaction.atomic():
            row.save(force_insert=action in {"create", "restore"})
            record_change(
                organisation=row.organisation, actor=actor, action=action, subject_type=SUBJECTS[type(row)], subject_id=row.pk,
                before=before, after=facts(row),
            )  # fmt: skip
    except IntegrityError as error:
        if any(name in str(error) for name in NAMES_TAKEN):
            raise NameTaken(SUBJECTS[type(row)]) from error
        if "uav_external_id_unique" in str(error):
            raise UavExternalIdTaken from error
        if "mavlink_system_id" in str(error):
            raise SystemIdTaken from error
        raise
    return row


def deleted(row: Row, *, actor: User, expected_revision: int | None, facts: Facts) -> None:
    """Delete a row that nothing points at. Raises FleetChanged or FleetRowInUse."""
    subject, key = SUBJECTS[type(row)], row.pk
    try:
        with transaction.atomic():
            held = locked(row, expected_revision)
            before = facts(held)
            held.delete()
            record_change(organisation=row.organisation, actor=actor, action="delete", subject_type=subject, subject_id=key, before=before)
    except ProtectedError as error:
        raise FleetRowInUse(subject, len(error.protected_objects)) from error


def facts_to_restore(model: type[Row], *, organisation: Organisation, key: int) -> dict[str, Any]:
    """Raises NotDeleted."""
    facts = facts_when_deleted(organisation, SUBJECTS[model], key)
    if facts is None or model._default_manager.filter(pk=key).exists():
        raise NotDeleted
    return facts
