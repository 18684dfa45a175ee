"""The UAVs of a gateway by MAVLink system id, with their keys."""

from dataclasses import dataclass, field

from missions.models import CredentialKind, LinkKind, Uav, UavCredential
from missions.services.fleet.credentials import mavlink_signing_key


@dataclass(frozen=True)
class KnownUav:
    """A UAV's row; values differ if any field was changed. Earlier keys are valid until the newest one was used."""

    uav_id: int
    organisation_id: int
    name: str
    system: int
    allows_unsigned: bool
    credential_id: int | None
    key: bytes | None = field(repr=False)
    earlier_keys: tuple[tuple[int, bytes], ...] = field(default=(), repr=False)

    @property
    def keys(self) -> tuple[tuple[int, bytes], ...]:
        """Return the valid keys by credential, the newest first."""
        newest = () if self.credential_id is None or self.key is None else ((self.credential_id, self.key),)
        return newest + self.earlier_keys


def known_uavs() -> dict[int, KnownUav]:
    """Return the UAVs with a MAVLink link, by system id."""
    keys: dict[int, list[tuple[int, bytes]]] = {}
    for credential in UavCredential.objects.filter(kind=CredentialKind.MAVLINK_KEY, revoked_at=None).order_by("-pk"):
        keys.setdefault(credential.uav_id, []).append((credential.pk, mavlink_signing_key(credential=credential)))
    uavs = Uav.objects.filter(mavlink_system_id__isnull=False, link=LinkKind.MAVLINK)
    fields = ("pk", "organisation_id", "name", "mavlink_system_id", "allows_unsigned")
    known = {}
    for uav_id, organisation_id, name, system, allows_unsigned in uavs.values_list(*fields):
        own = keys.get(uav_id, [])
        credential_id, key = own[0] if own else (None, None)
        known[system] = KnownUav(uav_id, organisation_id, name, system, allows_unsigned, credential_id, key, tuple(own[1:]))
    return known
