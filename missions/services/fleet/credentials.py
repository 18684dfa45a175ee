"""Credentials of UAVs: a token for the HTTP link, a key that signs MAVLink.

Each is shown once. Only what is needed to check it is stored: a token's SHA-256, the salt of a key.
"""

import secrets
from collections.abc import Collection
from dataclasses import dataclass
from datetime import datetime

from django.db import transaction
from django.db.models import Q
from django.utils import timezone
from django.utils.crypto import salted_hmac

from missions.models import CredentialKind, Uav, UavCredential
from missions.services.fleet.link_changes import refuse_while_needed
from missions.services.fleet.rows import locked
from workspace.api_tokens import USE_NOTED_EVERY, hash_token
from workspace.audit import record_change
from workspace.models import User
from workspace.prepared_statements import prepared_rows

KEY_PURPOSE = "missions.mavlink-signing-key"


@dataclass(frozen=True)
class NewCredential:
    credential: UavCredential
    secret: str  # cannot be read again


def make_credential(*, uav: Uav, actor: User, kind: CredentialKind, insist_reason: str = "") -> NewCredential:
    """Make a token or key. A used predecessor stays valid until the new one is used; an unused one is revoked at once.

    Raises Refused where one is replaced in flight, or with a command on its way, without a reason to insist.
    """
    with transaction.atomic():
        locked(uav, None)
        before = uav.credentials.filter(kind=kind, revoked_at=None)
        is_rotated = before.exists()
        if is_rotated and not insist_reason:
            refuse_while_needed(uav)
        before.filter(replaced_at=None, last_used_at=None).update(revoked_at=timezone.now())
        before.filter(replaced_at=None).update(replaced_at=timezone.now())
        token = f"spu_{secrets.token_urlsafe(32)}"
        credential = UavCredential.objects.create(
            uav=uav,
            kind=kind,
            created_by=actor,
            token_sha256=hash_token(token) if kind == CredentialKind.LINK_TOKEN else None,
            key_salt=secrets.token_hex(32) if kind == CredentialKind.MAVLINK_KEY else "",
        )
        _note(uav, actor, "rotate" if is_rotated else "create", credential, insist_reason)
    return NewCredential(credential, token if kind == CredentialKind.LINK_TOKEN else mavlink_signing_key(credential=credential).hex())


def revoke_credential(*, credential: UavCredential, actor: User, insist_reason: str = "") -> None:
    """Revoke a credential and those that it replaced, at once. A revoked one is left unchanged.

    Raises Refused as make_credential.
    """
    with transaction.atomic():
        locked(credential.uav, None)
        in_force = UavCredential.objects.filter(pk=credential.pk, revoked_at=None)
        if not in_force.exists():
            return
        if not insist_reason:
            refuse_while_needed(credential.uav)
        earlier = Q(uav=credential.uav_id, kind=credential.kind, pk__lt=credential.pk)
        UavCredential.objects.filter(Q(pk=credential.pk) | earlier, revoked_at=None).update(revoked_at=timezone.now())
        _note(credential.uav, actor, "revoke", credential, insist_reason)


# No request waits for the disk, as for the tokens of users.
_NOTE_USE = """
    WITH quick AS (SELECT set_config('synchronous_commit', 'off', true))
    UPDATE missions_uavcredential SET last_used_at = %s FROM quick WHERE id = %s"""


def note_link_token_use(*, credential_id: int, last_used_at: datetime | None) -> None:
    """Record when a UAV last authenticated with this token, to the minute, as it polls often. The first use ends earlier tokens."""
    now = timezone.now()
    if last_used_at is None or now - last_used_at >= USE_NOTED_EVERY:
        prepared_rows(_NOTE_USE, [now, credential_id])
    if last_used_at is None:
        _revoke_replaced_by([credential_id])


def note_mavlink_key_use(*, credential_ids: Collection[int]) -> None:
    """Record that UAVs have signed with these keys, which revokes earlier ones."""
    UavCredential.objects.filter(pk__in=credential_ids).update(last_used_at=timezone.now())
    _revoke_replaced_by(credential_ids)


def _revoke_replaced_by(used_ids: Collection[int]) -> None:
    """Revoke the predecessors of the newest credential of a kind after its first use: the UAV has it."""
    newest = UavCredential.objects.filter(pk__in=used_ids, revoked_at=None, replaced_at=None)
    for uav_id, kind in newest.values_list("uav", "kind"):
        replaced = UavCredential.objects.filter(uav=uav_id, kind=kind, revoked_at=None, replaced_at__isnull=False)
        replaced.update(revoked_at=timezone.now())


def mavlink_signing_key(*, credential: UavCredential) -> bytes:
    """Return the 32 bytes that both ends sign with. They are derived from the salt and this installation's secret key, and never stored."""
    return salted_hmac(KEY_PURPOSE, f"{credential.uav_id}:{credential.key_salt}", algorithm="sha256").digest()


def _note(uav: Uav, actor: User, action: str, credential: UavCredential, insist_reason: str) -> None:
    after = {"uav": uav.pk, "kind": credential.kind} | ({"insisted": insist_reason} if insist_reason else {})
    record_change(
        organisation=uav.organisation, actor=actor, action=action, subject_type="uav_credential", subject_id=credential.pk, after=after
    )  # fmt: skip
