"""What is to be flown, by whom, in which order."""

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
from missions.models.fleet import Base, CredentialKind, EndAction, LinkKind, Uav, UavCredential, UavState, UavType
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
    "OPEN_COMMANDS",
    "Approval",
    "Base",
    "CommandAxis",
    "CommandKind",
    "CommandPriority",
    "CommandState",
    "CredentialKind",
    "EndAction",
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
