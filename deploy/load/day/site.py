"""What a working day is played on, as prepare_day.py has made it: people, UAVs, towers, tiles. Holds a password and tokens: mode 0600."""

import os
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import orjson

FILE = "day.json"
OTHERS_FIXED = 6  # programs, curator, administrator


@dataclass(frozen=True)
class Person:
    name: str
    role: str


@dataclass(frozen=True)
class Desk:
    """An operator with a UAV that a companion computer tells what to do, and towers near where it stands (keys of assets)."""

    operator: str
    uav: int
    token: str
    position: tuple[float, float]
    towers: tuple[int, ...]


@dataclass(frozen=True)
class InAir:
    """A UAV that speaks MAVLink, on a mission that was started; its way as (lon, lat, altitude_relative_m), and the ground at its start."""

    uav: int
    system: int
    mission: str
    speed_mps: float
    ground_amsl_m: float
    way: tuple[tuple[float, float, float], ...]


@dataclass(frozen=True)
class Site:
    """`password` is everybody's; `programs` are bearer tokens; `tiles` are (zoom, column, row) that a map asks for, by place."""

    organisation: int
    password: str
    people: tuple[Person, ...]
    desks: tuple[Desk, ...]
    in_air: tuple[InAir, ...]
    programs: tuple[str, ...]
    places: tuple[tuple[tuple[int, int, int], ...], ...]
    towers: tuple[int, ...]
    box: tuple[float, float, float, float]

    def users_with_role(self, role: str) -> list[str]:
        return [person.name for person in self.people if person.role == role]

    @property
    def fixed_users(self) -> int:
        """Of working_day.py's table: those whose number does not follow the load."""
        return 2 * len(self.desks) + OTHERS_FIXED

    def write(self, folder: Path) -> None:
        path = folder / FILE
        path.touch(mode=0o600)
        path.chmod(0o600)
        path.write_bytes(orjson.dumps(asdict(self)))

    @classmethod
    def read(cls, folder: Path | None = None) -> "Site":
        """Of the folder, or of the one that SPANWISE_DAY names."""
        stored: dict[str, Any] = orjson.loads(((folder or Path(os.environ["SPANWISE_DAY"])) / FILE).read_bytes())
        stored["people"] = tuple(Person(**one) for one in stored["people"])
        stored["desks"] = tuple(Desk(**one) for one in stored["desks"])
        stored["in_air"] = tuple(InAir(**one) for one in stored["in_air"])
        return cls(**stored)
