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
    OBJECTIVES,
    WAYPOINT_KINDS,
    InspectionTarget,
    Mission,
    MissionState,
    MissionUav,
    Route,
    SavedSelection,
    TargetPriority,
    TargetState,
    Waypoint,
)
from missions.models.offers import OfferState, ReplanOffer
from missions.models.starts import PlannedStarts, StartsEnd

__all__ = [
    "ENDED_STATES",
    "END_ACTIONS",
    "OBJECTIVES",
    "OPEN_COMMANDS",
    "WAYPOINT_KINDS",
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
]
