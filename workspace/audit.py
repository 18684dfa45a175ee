"""The history: who changed what, before and after."""

from typing import Any

from workspace.models import (
    AuditEntry,
    Organisation,
    User,
)


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


def record_account_event(user: User, actor: User | None, action: str) -> None:
    """Record what happened to an account whose facts stay as they are."""
    facts = user_facts(user)
    record_change(
        organisation=user.organisation, actor=actor, action=action, subject_type="user", subject_id=user.pk, before=facts, after=facts
    )


def user_facts(user: User) -> dict[str, Any]:
    """Return the facts of an account for the history; never its password."""
    names = ("username", "first_name", "last_name", "email", "role", "is_active", "is_installation_operator")
    facts = {name: getattr(user, name) for name in names} | {"organisation": user.organisation.name}
    return facts | ({"is_service": True} if user.is_service else {})
