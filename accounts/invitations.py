"""Invitations: a link with which one user makes an account with the role that an administrator has chosen."""

import secrets
from datetime import timedelta
from enum import StrEnum

from django.conf import settings
from django.core.mail import send_mail
from django.db import transaction
from django.db.models import Q, QuerySet
from django.http import HttpRequest
from django.http.request import split_domain_port
from django.template.loader import render_to_string
from django.utils import timezone
from django.utils.translation import gettext as _

from accounts.users import save_user
from workspace.api_tokens import hash_token
from workspace.audit import record_change
from workspace.models import Invitation, Organisation, Role, User

MAX_DAYS = 30
MAX_TOKEN_LENGTH = 200
ON_THE_CONSOLE = "django.core.mail.backends.console.EmailBackend"


class InvitationState(StrEnum):
    OPEN = "open"
    ACCEPTED = "accepted"
    EXPIRED = "expired"
    REVOKED = "revoked"


class InvitationGone(Exception):
    """Raised for an invitation that is used, revoked, expired or unknown."""


def in_state(state: InvitationState) -> Q:
    unused = Q(accepted_at=None)
    now = timezone.now()
    return {
        InvitationState.OPEN: unused & Q(revoked_at=None, expires_at__gt=now),
        InvitationState.ACCEPTED: ~unused,
        InvitationState.EXPIRED: unused & Q(revoked_at=None, expires_at__lte=now),
        InvitationState.REVOKED: unused & Q(revoked_at__isnull=False),
    }[state]


def state_of(invitation: Invitation) -> InvitationState:
    if invitation.accepted_at:
        return InvitationState.ACCEPTED
    if invitation.revoked_at:
        return InvitationState.REVOKED
    return InvitationState.OPEN if invitation.expires_at > timezone.now() else InvitationState.EXPIRED


def invitations_of(actor: User) -> QuerySet[Invitation]:
    return Invitation.objects.filter(organisation_id=actor.organisation_id)


def invite(*, organisation: Organisation, actor: User | None, role: Role, email: str, days: int) -> tuple[Invitation, str]:
    """Return the row and the link's secret, which cannot be shown again. The actor is None for actions on the machine itself."""
    token = secrets.token_urlsafe(32)
    with transaction.atomic():
        invitation = Invitation.objects.create(
            organisation=organisation,
            email=email,
            role=role,
            token_sha256=hash_token(token),
            invited_by=actor,
            expires_at=timezone.now() + timedelta(days=days),
        )
        _record(invitation, actor, "created")
    return invitation, token


def mail_leaves_here() -> bool:
    """Whether mail is sent: the console backend would write a link into a log."""
    return bool(settings.EMAIL_BACKEND != ON_THE_CONSOLE)


def send_invitation(*, invitation: Invitation, link: str) -> bool:
    """Send the invitation; returns whether the mail server accepted it."""
    if not (invitation.email and mail_leaves_here()):
        return False
    text = render_to_string("account/invitation_mail.txt", {"invitation": invitation, "link": link})
    try:
        return bool(send_mail(_("Your account for Spanwise"), text, None, [invitation.email]))
    except OSError:  # includes SMTP's errors
        return False


def revoke_invitation(*, invitation: Invitation, actor: User) -> Invitation:
    """Revoke the link. A used one stays used; a repeated call changes nothing."""
    with transaction.atomic():
        if Invitation.objects.filter(in_state(InvitationState.OPEN), pk=invitation.pk).update(revoked_at=timezone.now()):
            _record(invitation, actor, "revoked")
    invitation.refresh_from_db()
    return invitation


def open_invitation(token: str) -> Invitation:
    """Return the open invitation of a token. Raises InvitationGone."""
    if not token.isascii() or len(token) > MAX_TOKEN_LENGTH:
        raise InvitationGone
    found = Invitation.objects.filter(in_state(InvitationState.OPEN), token_sha256=hash_token(token)).first()
    if found is None:
        raise InvitationGone
    return found


def accept_invitation(*, token: str, user: User) -> User:
    """Store the new account with the invitation's role; of two concurrent calls one fails. Raises InvitationGone."""
    with transaction.atomic():
        invitation = Invitation.objects.select_for_update().get(pk=open_invitation(token).pk)
        if state_of(invitation) != InvitationState.OPEN:
            raise InvitationGone
        user.role, user.organisation_id = invitation.role, invitation.organisation_id
        save_user(user=user, actor=user)
        invitation.accepted_at, invitation.accepted_by = timezone.now(), user
        invitation.save(update_fields=["accepted_at", "accepted_by"])
        _record(invitation, user, "accepted")
    return user


def _record(invitation: Invitation, actor: User | None, action: str) -> None:
    facts = {"role": str(invitation.role), "email": invitation.email, "expires_at": invitation.expires_at.isoformat(timespec="seconds")}
    before, after = (None, facts) if action == "created" else (facts, None)
    record_change(
        organisation=invitation.organisation,
        actor=actor,
        action=action,
        subject_type="invitation",
        subject_id=invitation.pk,
        before=before,
        after=after,
    )


OWN_MACHINE = {"127.0.0.1", "localhost", "[::1]"}


def public_address(request: HttpRequest) -> str:
    """Return scheme and host of `SPANWISE_PUBLIC_ADDRESS`.

    Without it, returns the requested host, which is one of `SPANWISE_ALLOWED_HOSTS`. Its port counts only on localhost, as the client could
    name another program's.
    """
    if settings.PUBLIC_ADDRESS:
        return str(settings.PUBLIC_ADDRESS)
    host = request.get_host()
    name = split_domain_port(host)[0]
    return f"{'https' if request.is_secure() else 'http'}://{host if name in OWN_MACHINE else name}"
