"""The UAVs as a gateway needs them: by MAVLink system id, each with its key."""

from dataclasses import dataclass, field

from missions.models import CredentialKind, LinkKind, Uav, UavCredential
from missions.services.credentials import mavlink_signing_key


@dataclass(frozen=True)
class KnownUav:
    """Another value means that something about it was changed."""

    uav_id: int
    organisation_id: int
    name: str
    system: int
    allows_unsigned: bool
    credential_id: int | None
    key: bytes | None = field(repr=False)


def known_uavs() -> dict[int, KnownUav]:
    """By system id. A UAV whose link is not MAVLink is not a gateway's."""
    credentials = UavCredential.objects.filter(kind=CredentialKind.MAVLINK_KEY, revoked_at=None)
    keys = {credential.uav_id: credential for credential in credentials}
    uavs = Uav.objects.filter(mavlink_system_id__isnull=False, link=LinkKind.MAVLINK)
    fields = ("pk", "organisation_id", "name", "mavlink_system_id", "allows_unsigned")
    return {
        system: KnownUav(
            uav_id=uav_id,
            organisation_id=organisation_id,
            name=name,
            system=system,
            allows_unsigned=allows_unsigned,
            credential_id=keys[uav_id].pk if uav_id in keys else None,
            key=mavlink_signing_key(credential=keys[uav_id]) if uav_id in keys else None,
        )
        for uav_id, organisation_id, name, system, allows_unsigned in uavs.values_list(*fields)
    }
