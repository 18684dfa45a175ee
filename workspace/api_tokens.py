"""API tokens: made once, stored as a hash, their use recorded."""

import hashlib
import secrets
from collections.abc import Iterable
from datetime import datetime, timedelta

from django.utils import timezone

from workspace.models import (
    SCOPES_OF_ROLE,
    ApiToken,
    User,
)
from workspace.prepared_statements import prepared_rows

# No request waits for the disk: a power failure may lose the uses of the last fraction of a second.
_NOTE_USE = """
    WITH quick AS (SELECT set_config('synchronous_commit', 'off', true))
    UPDATE workspace_apitoken SET last_used_at = %s FROM quick WHERE id = %s"""
USE_NOTED_EVERY = timedelta(minutes=1)


def hash_token(token: str) -> str:
    return hashlib.sha256(token.encode()).hexdigest()


def create_api_token(*, user: User, name: str, expires_at: datetime, scopes: Iterable[str] | None = None) -> str:
    """Make a bearer token with these scopes, or all of the role, and return it; it cannot be shown again."""
    token = f"spw_{secrets.token_urlsafe(32)}"
    given = list(SCOPES_OF_ROLE[user.role] if scopes is None else scopes)
    ApiToken.objects.create(user=user, name=name, token_sha256=hash_token(token), expires_at=expires_at, scopes=given)
    return token


def note_use(*, token: int, last_used_at: datetime | None) -> None:
    """Store when the token with this key was last used, to the minute, so that frequent requests write rarely."""
    now = timezone.now()
    if last_used_at is None or now - last_used_at >= USE_NOTED_EVERY:
        prepared_rows(_NOTE_USE, [now, token])
