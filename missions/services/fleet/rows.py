"""What all writes to the fleet share: one lock, one revision, one history entry, and restoring after a deletion."""

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


class FleetNameTaken(Exception):
    """Raised when another row of the same kind has this name; `subject` is the kind."""

    def __init__(self, subject: str = "uav") -> None:
        super().__init__(subject)
        self.subject = subject


class UavExternalIdTaken(Exception):
    """Raised when another UAV of the organisation has this external id."""


class SystemIdTaken(Exception):
    """Raised when another UAV has this MAVLink system id."""


class SystemIdQuota(Exception):
    """Raised when the organisation has its maximum number of MAVLink system ids."""

    def __init__(self, limit: int) -> None:
        super().__init__(str(limit))
        self.limit = limit


class FleetChanged(Exception):
    """Raised when another user changed the row after the caller read it."""

    def __init__(self, subject: str, key: int) -> None:
        super().__init__(f"{subject} {key}")
        self.subject = subject
        self.key = key


class FleetRowInUse(Exception):
    """Raised when other rows refer to the row: missions to a UAV, UAVs to a type or a base."""

    def __init__(self, subject: str, users: int) -> None:
        super().__init__(f"{subject}: {users}")
        self.subject = subject
        self.users = users


class NotDeleted(Exception):
    """Raised when there is no deleted row to restore."""


def locked(row: Row, expected_revision: int | None) -> Row:
    """Return the current row, locked until the caller's transaction ends. Raises FleetChanged.

    The lock also blocks new rows that refer to it, such as a UAV's records. A name or a system id is a key: changing one under a weaker
    lock while a report of the UAV is being stored would deadlock.
    """
    held = type(row)._default_manager.select_for_update().filter(pk=row.pk).first()
    if held is None or (expected_revision is not None and held.revision != expected_revision):
        raise FleetChanged(SUBJECTS[type(row)], row.pk)
    return held


def stored(row: Row, *, actor: User | None, action: str, before: dict[str, Any] | None, facts: Facts) -> Row:
    """Save a row that is new, changed or restored, with its history entry.

    Raises FleetNameTaken, ExternalIdTaken or SystemIdTaken.
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
            raise FleetNameTaken(SUBJECTS[type(row)]) from error
        if "uav_external_id_unique" in str(error):
            raise UavExternalIdTaken from error
        if "mavlink_system_id" in str(error):
            raise SystemIdTaken from error
        raise
    return row


def deleted(row: Row, *, actor: User, expected_revision: int | None, facts: Facts) -> None:
    """Delete a row that no other row refers to. Raises FleetChanged or FleetRowInUse."""
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
    """Return the facts of a deleted row. Raises NotDeleted."""
    facts = facts_when_deleted(organisation, SUBJECTS[model], key)
    if facts is None or model._default_manager.filter(pk=key).exists():
        raise NotDeleted
    return facts
