"""Writes of users by administrators: roles, access, deletion, installation operators. Each is recorded in the history."""

from collections.abc import Iterable
from typing import Any

from allauth.account.models import EmailAddress
from django.db import transaction
from django.utils import timezone
from django.utils.translation import gettext as _

from workspace.api.permissions import may_change
from workspace.audit import record_change, user_facts
from workspace.leases import lock_until_end
from workspace.models import (
    DEFAULT_ORGANISATION_ID,
    AuditEntry,
    Invitation,
    Role,
    User,
)

ADMINISTRATORS_LOCK = 0x05A7_0003  # advisory lock: changes that remove an administrator are serialised


class NoAdministratorLeft(ValueError):
    """Raised when no administrator who may log in would be left, so that no user could restore the role."""

    def __init__(self) -> None:
        super().__init__(_("This would leave no administrator who can sign in. Make somebody else an administrator first."))


class OperatorsAlone(PermissionError):
    """Raised when another user would change an installation operator's account, and so could become one."""

    def __init__(self) -> None:
        super().__init__(_("Only installation operators change the account of one."))


def save_user(*, user: User, actor: User | None) -> User:
    """Store a new or changed account; without an actor the identity provider has changed it. Raises NoAdministratorLeft, OperatorsAlone."""
    with transaction.atomic():
        before = User.objects.filter(pk=user.pk).first()
        if before and actor and not may_change(actor, before):
            raise OperatorsAlone
        user.save()
        EmailAddress.objects.filter(user=user).exclude(email=user.email.lower()).delete()  # verified for that address only
        _refuse_without_administrator(before)
        if before and _administrates(before) and not (_administrates(user) and before.organisation_id == user.organisation_id):
            _withdraw_invitations(user, actor)
        places = {actor.organisation_id} if actor else {user.organisation_id, before.organisation_id if before else user.organisation_id}
        for organisation_id in sorted(places):
            _record_user(actor, user.pk, user_facts(before) if before else None, user_facts(user), organisation_id)
    return user


def change_users(*, users: Iterable[User], actor: User, role: Role | None = None, is_active: bool | None = None) -> int:
    """Set the role or access of several accounts; returns how many were changed. Raises as save_user."""
    changed = 0
    with transaction.atomic():
        for user in users:
            wanted = (user.role if role is None else role, user.is_active if is_active is None else is_active)
            if wanted != (user.role, user.is_active):
                user.role, user.is_active = wanted
                save_user(user=user, actor=actor)
                changed += 1
    return changed


def delete_user(*, user: User, actor: User) -> None:
    """Delete a user. Their actions stay in the history, without their name. Raises NoAdministratorLeft, OperatorsAlone."""
    if not may_change(actor, User.objects.get(pk=user.pk)):
        raise OperatorsAlone
    with transaction.atomic():
        before, key = user_facts(user), user.pk
        held = User(role=user.role, is_active=user.is_active, organisation_id=user.organisation_id, is_service=user.is_service)
        _withdraw_invitations(user, actor)
        user.delete()
        _refuse_without_administrator(held)
        is_own = actor.pk == key
        _record_user(None if is_own else actor, key, before, None, DEFAULT_ORGANISATION_ID if is_own else actor.organisation_id)


def set_installation_operator(*, user: User, is_operator: bool) -> None:
    """Grant or revoke the installation operator flag. Only a command on the machine does this; no page or endpoint."""
    with transaction.atomic():
        before = user_facts(user)
        user.is_installation_operator = is_operator
        user.save(update_fields=["is_installation_operator"])
        record_change(
            organisation=user.organisation, actor=None, action="changed", subject_type="user", subject_id=user.pk,
            before=before, after=user_facts(user),
        )  # fmt: skip


def _refuse_without_administrator(before: User | None) -> None:
    """Raise NoAdministratorLeft after a change, in its transaction. Concurrent changes are serialised here."""
    if before is None or not _administrates(before):
        return
    lock_until_end(ADMINISTRATORS_LOCK)
    left = User.objects.filter(is_active=True, is_service=False)
    administrators = left.filter(role=Role.ADMINISTRATOR)
    own = before.organisation_id
    if not administrators.exists() or (left.filter(organisation=own).exists() and not administrators.filter(organisation=own).exists()):
        raise NoAdministratorLeft


def _administrates(user: User) -> bool:
    return user.role == Role.ADMINISTRATOR and user.is_active and not user.is_service


def _withdraw_invitations(user: User, actor: User | None) -> None:
    """Withdraw the open invitations of a user who loses the role or access, as they could restore it."""
    now = timezone.now()
    still_open = Invitation.objects.filter(invited_by=user, accepted_at=None, revoked_at=None, expires_at__gt=now)
    for invitation in still_open.select_for_update():
        invitation.revoked_at = now
        invitation.save(update_fields=["revoked_at"])
        record_change(
            organisation=invitation.organisation, actor=actor, action="revoked", subject_type="invitation", subject_id=invitation.pk,
            before={"role": invitation.role, "email": invitation.email},
        )  # fmt: skip


def _record_user(actor: User | None, key: int, before: dict[str, Any] | None, after: dict[str, Any] | None, organisation_id: int) -> None:
    if before == after:
        return
    action = "changed" if before and after else "created" if after else "deleted"
    AuditEntry.objects.create(
        organisation_id=organisation_id, actor=actor, action=action, subject_type="user", subject_id=str(key), before=before, after=after
    )
