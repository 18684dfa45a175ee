"""A vehicle's onboard lists by readback, written together with the end of the command that uploaded them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import timedelta
from enum import StrEnum
from uuid import UUID

from django.db import transaction
from django.db.models.functions import Now

from missions.models import UavCommand
from missions.services.commands.commands import note_applied, note_failed, note_sent
from operation.reasons import Why
from telemetry.models import UavLink


@dataclass(frozen=True)
class LoadedLists:
    """The onboard lists. `sha256` is a FlightLoad's.

    `beside` has the hashes of the vehicle's own lists kept beside it, by kind: fence or rally.
    """

    sha256: str
    approval: UUID
    flight: int
    beside: Mapping[str, str] = field(default_factory=dict, compare=False)
    doubt: str = field(default="", compare=False)


@dataclass(frozen=True)
class Carried:
    """A command in delivery and its holder; updates with it are ignored once another holder has the command."""

    command_id: UUID
    uav_id: int
    attempt: int
    holder: str

    @classmethod
    def of(cls, command: UavCommand) -> "Carried":
        return cls(command.pk, command.uav_id, command.attempts, command.holder)


def loaded_on(uav_id: int) -> LoadedLists | None:
    link = UavLink.objects.filter(uav=uav_id).exclude(loaded_sha256="").first()
    if link is None or link.loaded_approval is None or link.loaded_flight is None:
        return None
    return LoadedLists(link.loaded_sha256, link.loaded_approval, link.loaded_flight, link.loaded_beside, link.loaded_doubt)


class Doubt(StrEnum):
    """Why a vehicle may hold another list than was read back."""

    REBOOTED = "rebooted"
    OTHER_STATION = "other-station"  # it has exchanged mission messages with another station
    OTHER_LENGTH = "other-length"  # its list has another number of items


def doubt_loaded(*, uav_id: int, doubt: Doubt, ago_s: float) -> None:
    """Mark the readback as doubtful, by an observation `ago_s` ago; later readbacks are unaffected. A reboot is the weakest doubt."""
    doubted = UavLink.objects.filter(uav=uav_id, loaded_read_at__lt=Now() - timedelta(seconds=ago_s)).exclude(loaded_approval=None)
    weaker = {"", Doubt.REBOOTED} if doubt is not Doubt.REBOOTED else {""}
    doubted.filter(loaded_doubt__in=weaker).update(loaded_doubt=doubt)


def confirm_loaded(carried: Carried, loaded: LoadedLists) -> None:
    """Store that another readback found the same list."""
    UavLink.objects.filter(uav=carried.uav_id, loaded_sha256=loaded.sha256).update(loaded_read_at=Now(), loaded_doubt="")


def begin_loading(carried: Carried) -> bool:
    """Mark the onboard list as unknown during an upload. Returns False if another holder has the command."""
    with transaction.atomic():
        if not note_sent(carried.command_id, attempt=carried.attempt, holder=carried.holder):
            return False
        _write(carried.uav_id, None)
    return True


def end_loading(carried: Carried, loaded: LoadedLists | None, *, note: Why = (), warnings: Why = ()) -> bool:
    """Store that the vehicle holds `loaded`, or nothing. Returns False if another holder has the command."""
    with transaction.atomic():
        if not note_applied(carried.command_id, attempt=carried.attempt, holder=carried.holder, note=note, warnings=warnings):
            return False
        _write(carried.uav_id, loaded)
    return True


def fail_loading(carried: Carried, before: LoadedLists | None, code: str, why: Why) -> bool:
    """Store a failed upload. before: the approved list that the vehicle still holds; None if unknown or not approved."""
    with transaction.atomic():
        if not note_failed(carried.command_id, code, why, attempt=carried.attempt, holder=carried.holder):
            return False
        _write(carried.uav_id, before)
    return True


def _write(uav_id: int, loaded: LoadedLists | None) -> None:
    link = UavLink.objects.filter(uav=uav_id)
    if loaded is None:
        link.update(loaded_sha256="", loaded_approval=None, loaded_flight=None, loaded_read_at=None, loaded_doubt="", loaded_beside={})
    else:
        named = {"loaded_sha256": loaded.sha256, "loaded_approval": loaded.approval, "loaded_flight": loaded.flight}
        link.update(**named, loaded_read_at=Now(), loaded_doubt="", loaded_beside=dict(loaded.beside))
