"""Photos that were taken in a mission's rehearsals and flights, as later apps know them."""

from collections.abc import Sequence
from dataclasses import dataclass
from uuid import UUID

from django.utils.module_loading import import_string

from missions.models import Mission
from planning.views.proof import TakenPhoto

_rehearsed: list[str] = []
_achieved: list[str] = []


@dataclass(frozen=True, slots=True)
class PhotoOfMission:
    """A photo with the UAV's place in the mission and the waypoint of its route, None where they are unknown.

    relative_m: above the take-off of its flight (from 1), for photos whose height above the sea follows from it.
    """

    photo: TakenPhoto
    uav: int | None
    waypoint: int | None
    relative_m: float | None = None
    flight: int = 1


@dataclass(frozen=True, slots=True)
class RehearsedPhotos:
    """Photos of one run of a rehearsal. is_outdated: it flew another plan. code, name: of the conditions; name: own ones'."""

    rehearsal: UUID
    run: int
    code: str
    name: str
    is_outdated: bool
    photos: Sequence[PhotoOfMission]


def register_rehearsed_photos(name: str) -> None:
    """Register a function by its dotted name. It takes a mission and a rehearsal's key or None, the newest, and returns RehearsedPhotos.

    Raises LookupError where the mission has no such rehearsal.
    """
    if name not in _rehearsed:
        _rehearsed.append(name)


def register_achieved_photos(name: str) -> None:
    """Register a function by its dotted name. It takes a mission and returns the photos that its UAVs reported, or None without flight."""
    if name not in _achieved:
        _achieved.append(name)


def rehearsed_photos(mission: Mission, rehearsal: UUID | None) -> list[RehearsedPhotos]:
    """Return the photos of each run of a rehearsal, the newest without key. Raises LookupError."""
    return [run for name in _rehearsed for run in import_string(name)(mission, rehearsal)]


def achieved_photos(mission: Mission) -> list[PhotoOfMission] | None:
    """Return the photos that UAVs reported; None while nothing of the mission was flown."""
    found = [photos for name in _achieved if (photos := import_string(name)(mission)) is not None]
    return [photo for photos in found for photo in photos] if found else None
