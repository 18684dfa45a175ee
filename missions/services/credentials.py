"""What a UAV proves itself with: a token for the HTTP link, a key that signs MAVLink.

Each is shown once. Kept is only what is needed to check it: a token's SHA-256, the salt of a key.
"""

import secrets
from collections.abc import Collection
from dataclasses import dataclass
from datetime import datetime

from django.db import transaction
from django.utils import timezone
from django.utils.crypto import salted_hmac

from missions.models import CredentialKind, Uav, UavCredential
from missions.services.fleet_rows import locked
from workspace.models import User
from workspace.prepared import prepared_rows
from workspace.services import USE_NOTED_EVERY, hash_token, record_change

KEY_PURPOSE = "missions.mavlink-signing-key"


@dataclass(frozen=True)
class NewCredential:
    credential: UavCredential
    secret: str  # nobody can read it again


def make_credential(*, uav: Uav, actor: User, kind: CredentialKind) -> NewCredential:
    """A new token or key; the one before it no longer counts from this moment."""
    with transaction.atomic():
        locked(uav, None)
        replaced = _revoke_all(uav, kind)
        token = f"spu_{secrets.token_urlsafe(32)}"
        credential = UavCredential.objects.create(
            uav=uav,
            kind=kind,
            created_by=actor,
            token_sha256=hash_token(token) if kind == CredentialKind.LINK_TOKEN else None,
            key_salt=secrets.token_hex(32) if kind == CredentialKind.MAVLINK_KEY else "",
        )
        _note(uav, actor, "rotate" if replaced else "create", credential)
    return NewCredential(credential, token if kind == CredentialKind.LINK_TOKEN else mavlink_signing_key(credential=credential).hex())


def revoke_credential(*, credential: UavCredential, actor: User) -> None:
    """Nothing happens to one that no longer counts."""
    with transaction.atomic():
        if UavCredential.objects.filter(pk=credential.pk, revoked_at=None).update(revoked_at=timezone.now()):
            _note(credential.uav, actor, "revoke", credential)


# Nobody waits for the disk, as for the tokens of users.
_NOTE_USE = """
    WITH quick AS (SELECT set_config('synchronous_commit', 'off', true))
    UPDATE missions_uavcredential SET last_used_at = %s FROM quick WHERE id = %s"""


def note_link_token_use(*, credential_id: int, last_used_at: datetime | None) -> None:
    """When a UAV proved itself with this token last, to the minute: it asks every few seconds."""
    now = timezone.now()
    if last_used_at is None or now - last_used_at >= USE_NOTED_EVERY:
        prepared_rows(_NOTE_USE, [now, credential_id])


def note_mavlink_key_use(*, credential_ids: Collection[int]) -> None:
    """UAVs have signed with these."""
    UavCredential.objects.filter(pk__in=credential_ids).update(last_used_at=timezone.now())


def mavlink_signing_key(*, credential: UavCredential) -> bytes:
    """The 32 bytes that both ends sign with: made from the salt and this installation's secret key, and stored nowhere."""
    return salted_hmac(KEY_PURPOSE, f"{credential.uav_id}:{credential.key_salt}", algorithm="sha256").digest()


def _revoke_all(uav: Uav, kind: CredentialKind) -> bool:
    return bool(uav.credentials.filter(kind=kind, revoked_at=None).update(revoked_at=timezone.now()))


def _note(uav: Uav, actor: User, action: str, credential: UavCredential) -> None:
    record_change(
        organisation=uav.organisation, actor=actor, action=action, subject_type="uav_credential", subject_id=credential.pk,
        after={"uav": uav.pk, "kind": credential.kind},
    )  # fmt: skip
