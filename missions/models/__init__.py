"""What is to be flown, by whom, in which order."""

from missions.models.fleet import Base, CredentialKind, EndAction, Uav, UavCredential, UavState, UavType
from missions.models.missions import (
    InspectionTarget,
    Mission,
    MissionState,
    MissionUav,
    Objective,
    Route,
    SavedSelection,
    TargetPriority,
    TargetState,
    Waypoint,
    WaypointKind,
)

__all__ = [
    "Base",
    "CredentialKind",
    "EndAction",
    "InspectionTarget",
    "Mission",
    "MissionState",
    "MissionUav",
    "Objective",
    "Route",
    "SavedSelection",
    "TargetPriority",
    "TargetState",
    "Uav",
    "UavCredential",
    "UavState",
    "UavType",
    "Waypoint",
    "WaypointKind",
]
