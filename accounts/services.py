"""Writes of accounts, by their users and by administrators: preferences, passwords, sessions, tokens."""

import json
import zlib
from collections.abc import Iterable, Mapping
from datetime import datetime, timedelta
from typing import Any

from django.db import IntegrityError, transaction
from django.db.models import Count, F, Max, Q, QuerySet
from django.utils import timezone
from django.utils.translation import gettext as _

from accounts.users import save_user
from workspace.api_tokens import create_api_token
from workspace.audit import record_account_event, record_change
from workspace.models import ApiToken, Organisation, Role, User

MAX_TOKENS = 50  # of one user, valid at the same time
CHANGEABLE_BY_ADMINISTRATORS = ("first_name", "last_name", "email", "role", "is_active")


class ChangedMeanwhile(Exception):
    """Raised when the user was changed since; nothing was stored. `person` is the current row."""

    def __init__(self, person: User) -> None:
        super().__init__("changed meanwhile")
        self.person = person


class OrganisationChanged(Exception):
    """Raised when the organisation was changed since; nothing was stored. `organisation` is the current row."""

    def __init__(self, organisation: Organisation) -> None:
        super().__init__(_("Another administrator has changed the organisation meanwhile."))
        self.organisation = organisation


class TooManyTokens(Exception):
    """Raised at the limit of valid tokens, each of which could be stolen: old ones must be revoked first."""


def change_account(*, user: User, **values: Any) -> User:
    """Change the user's own name and preferences."""
    for name, value in values.items():
        setattr(user, name, value)
    user.save(update_fields=list(values))
    return user


def change_organisation(
    *, organisation: Organisation, actor: User, values: Mapping[str, Any], expected_revision: int | None = None
) -> Organisation:
    """Change name and time zone, with an entry in the history. Raises OrganisationChanged."""
    if not values:
        return organisation
    with transaction.atomic():
        held = Organisation.objects.select_for_update().get(pk=organisation.pk)
        if expected_revision is not None and held.revision != expected_revision:
            raise OrganisationChanged(held)
        before = {name: getattr(held, name) for name in values}
        for name, value in values.items():
            setattr(held, name, value)
        held.revision += 1
        held.save(update_fields=[*values, "revision"])
        record_change(
            organisation=held,
            actor=actor,
            action="change",
            subject_type="organisation",
            subject_id=held.pk,
            before=before,
            after=dict(values),
        )
    return held


def change_password(*, user: User, password: str, ends_tokens: bool = False) -> None:
    """Set the password and end all sessions, optionally revoking tokens; the caller keeps its own session."""
    with transaction.atomic():
        user.set_password(password)
        user.save(update_fields=["password"])
        record_account_event(user, user, "password changed")
        if ends_tokens:
            revoke_tokens(user=user, actor=user)


def revoke_tokens(*, user: User, actor: User) -> None:
    """Revoke all valid tokens of the user."""
    with transaction.atomic():
        for token in user.api_tokens.filter(revoked_at=None):
            revoke_token(token=token, actor=actor)


def end_sessions(*, user: User, actor: User | None) -> None:
    """End all sessions at once; the caller may keep its own. Tokens stay valid."""
    with transaction.atomic():
        User.objects.filter(pk=user.pk).update(session_generation=F("session_generation") + 1)
        user.refresh_from_db(fields=["session_generation"])
        record_account_event(user, actor, "signed out everywhere")


def make_token(*, user: User, name: str, days: int, scopes: Iterable[str] | None = None, actor: User | None = None) -> tuple[ApiToken, str]:
    """Return the row and the token itself, which cannot be shown again. The default actor is the user. Raises TooManyTokens."""
    expires_at = timezone.now() + timedelta(days=days)
    with transaction.atomic():
        User.objects.select_for_update().get(pk=user.pk)
        if user.api_tokens.filter(revoked_at=None, expires_at__gt=timezone.now()).count() >= MAX_TOKENS:
            raise TooManyTokens
        token = create_api_token(user=user, name=name, expires_at=expires_at, scopes=scopes)
        row = user.api_tokens.latest("pk")
        _record_token(row, actor or user, "created", {"name": name, "expires_at": _seconds(expires_at), "scopes": row.scopes})
    return row, token


def revoke_token(*, token: ApiToken, actor: User) -> ApiToken:
    """Revoke the token. A repeated call changes nothing."""
    with transaction.atomic():
        if ApiToken.objects.filter(pk=token.pk, revoked_at=None).update(revoked_at=timezone.now()):
            _record_token(token, actor, "revoked", {"name": token.name})
    token.refresh_from_db()
    return token


def revision_of_user(user: User) -> int:
    """Return a short digest of what administrators change, to detect concurrent changes."""
    facts = json.dumps([getattr(user, name) for name in CHANGEABLE_BY_ADMINISTRATORS])
    return zlib.crc32(facts.encode()) % 1_000_000_000


def change_user(*, user_id: int, actor: User, seen_revision: int | None, **values: Any) -> User:
    """Change a user. Raises User.DoesNotExist (another organisation's), ChangedMeanwhile, NoAdministratorLeft, OperatorsAlone."""
    with transaction.atomic():
        user = User.objects.select_for_update().get(pk=user_id, organisation_id=actor.organisation_id)
        if seen_revision is not None and seen_revision != revision_of_user(user):
            raise ChangedMeanwhile(user)
        for name, value in values.items():
            setattr(user, name, value)
        return save_user(user=user, actor=actor)


def _record_token(token: ApiToken, actor: User, action: str, facts: dict[str, Any]) -> None:
    facts |= {"of": token.user.username} if token.user_id != actor.pk else {}
    before, after = (None, facts) if action == "created" else (facts, None)
    record_change(
        organisation=actor.organisation, actor=actor, action=action, subject_type="token", subject_id=token.pk, before=before, after=after
    )


def _seconds(time: datetime) -> str:
    return time.isoformat(timespec="seconds")


class AccountNameTaken(ValueError):
    """Raised when the organisation has a service account of this name."""


def service_accounts_of(actor: User) -> QuerySet[User]:
    """Return those of the actor's organisation, with `valid_tokens` and `last_used_at`."""
    valid = Q(api_tokens__revoked_at=None, api_tokens__expires_at__gt=timezone.now())
    own = User.objects.filter(organisation_id=actor.organisation_id, is_service=True)
    return own.annotate(valid_tokens=Count("api_tokens", filter=valid), last_used_at=Max("api_tokens__last_used_at"))


def name_of(account: User) -> str:
    return account.username.split(":", 2)[2]


def make_service_account(*, actor: User, name: str, role: Role) -> User:
    """Create a service account. Raises AccountNameTaken."""
    username = f"service:{actor.organisation_id}:{name}"
    if User.objects.filter(username__iexact=username).exists():
        raise AccountNameTaken
    account = User(username=username, role=role, organisation_id=actor.organisation_id, is_service=True)
    account.set_unusable_password()
    try:
        with transaction.atomic():
            return save_user(user=account, actor=actor)
    except IntegrityError as error:  # concurrent requests
        raise AccountNameTaken from error


def tokens_of(account: User) -> QuerySet[ApiToken]:
    """Return the account's tokens: valid ones first, then the newest."""
    return account.api_tokens.select_related("user").order_by(F("revoked_at").desc(nulls_first=True), "-created_at")
