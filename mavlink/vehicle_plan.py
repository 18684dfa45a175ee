"""The plan that a vehicle receives: mission items, fence and rally points, and their hash."""

import hashlib
import json
import math
from dataclasses import dataclass
from enum import IntEnum


class MissionType(IntEnum):
    """MAV_MISSION_TYPE: the three lists of a vehicle."""

    MISSION = 0
    FENCE = 1
    RALLY = 2


@dataclass(frozen=True)
class MissionItem:
    """One MISSION_ITEM_INT without its place in the list.

    `command` is a MAV_CMD, `frame` a MAV_FRAME, `parameters` the first four, with NaN for the autopilot's choice. `longitude_e7` and
    `latitude_e7` are in 1e-7 degrees. The reference of `altitude_m` is that of the frame. `waypoint` is the related waypoint of the route.
    """

    command: int
    frame: int
    parameters: tuple[float, float, float, float]
    longitude_e7: int = 0
    latitude_e7: int = 0
    altitude_m: float = 0.0
    waypoint: int | None = None


@dataclass(frozen=True)
class FlightLoad:
    """The lists for one flight of one UAV. Home, where an autopilot expects it, is not among the mission items."""

    mission: tuple[MissionItem, ...]
    fence: tuple[MissionItem, ...] = ()
    rally: tuple[MissionItem, ...] = ()

    def of(self, kind: MissionType) -> tuple[MissionItem, ...]:
        return {MissionType.MISSION: self.mission, MissionType.FENCE: self.fence, MissionType.RALLY: self.rally}[kind]

    @property
    def content_sha256(self) -> str:
        """Return the hash of this load; NaN is written as null."""
        return hashlib.sha256(json.dumps(load_to_json(self), sort_keys=True, separators=(",", ":")).encode()).hexdigest()


def load_to_json(load: FlightLoad) -> dict[str, list[list[int | float | None]]]:
    """Return the lists by name, each item as [command, frame, p1, p2, p3, p4, longitude_e7, latitude_e7, altitude_m, waypoint]."""
    return {kind.name.lower(): [_item_to_json(item) for item in load.of(kind)] for kind in MissionType}


def load_from_json(stored: dict[str, list[list[int | float | None]]]) -> FlightLoad:
    return FlightLoad(*(tuple(_item_from_json(row) for row in stored[kind.name.lower()]) for kind in MissionType))


def _item_to_json(item: MissionItem) -> list[int | float | None]:
    parameters = [None if math.isnan(value) else float(value) for value in item.parameters]
    return [item.command, item.frame, *parameters, item.longitude_e7, item.latitude_e7, float(item.altitude_m), item.waypoint]


def _item_from_json(row: list[int | float | None]) -> MissionItem:
    command, frame, *parameters, longitude_e7, latitude_e7, altitude_m, waypoint = row
    assert command is not None and frame is not None and longitude_e7 is not None  # noqa: S101 - as it was written
    assert latitude_e7 is not None and altitude_m is not None  # noqa: S101
    one, two, three, four = (math.nan if value is None else float(value) for value in parameters)
    return MissionItem(
        command=int(command),
        frame=int(frame),
        parameters=(one, two, three, four),
        longitude_e7=int(longitude_e7),
        latitude_e7=int(latitude_e7),
        altitude_m=float(altitude_m),
        waypoint=None if waypoint is None else int(waypoint),
    )
