"""Models of missions, the fleet and commands."""

from missions.models.commands import (
    OPEN_COMMANDS,
    Approval,
    CommandAxis,
    CommandKind,
    CommandPriority,
    CommandState,
    UavCommand,
    UavCommandEvent,
)
from missions.models.fleet import END_ACTIONS, Base, CredentialKind, LinkKind, Uav, UavCredential, UavState, UavType
from missions.models.missions import (
    ENDED_STATES,
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
from missions.models.offers import OfferState, ReplanOffer
from missions.models.starts import PlannedStarts, StartsEnd

__all__ = [
    "ENDED_STATES",
    "END_ACTIONS",
    "OPEN_COMMANDS",
    "Approval",
    "Base",
    "CommandAxis",
    "CommandKind",
    "CommandPriority",
    "CommandState",
    "CredentialKind",
    "InspectionTarget",
    "LinkKind",
    "Mission",
    "MissionState",
    "MissionUav",
    "Objective",
    "OfferState",
    "PlannedStarts",
    "ReplanOffer",
    "Route",
    "SavedSelection",
    "StartsEnd",
    "TargetPriority",
    "TargetState",
    "Uav",
    "UavCommand",
    "UavCommandEvent",
    "UavCredential",
    "UavState",
    "UavType",
    "Waypoint",
    "WaypointKind",
]
