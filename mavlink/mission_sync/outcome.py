"""What became of bringing a load onto a vehicle."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from mavlink.mission_sync.compare import ItemDifference
from mavlink.vehicle_plan import MissionType
from operation.reasons import Reason


class SyncState(StrEnum):
    READY = "ready"  # it holds what was approved
    INTACT = "intact"  # it failed, and all lists are as they were before
    CLEARED = "cleared"  # it failed, and the mission was taken off
    MIXED = "mixed"  # it holds what nobody approved, and could not be rid of it
    UNREAD = "unread"  # it failed, and what it holds could not be read


@dataclass(frozen=True)
class Mix:
    """A list that was found to be neither the approved one nor the one before."""

    kind: MissionType
    what: Reason


@dataclass(frozen=True)
class SyncOutcome:
    """`code` names why it failed; `sha256` is of the load that the vehicle holds, empty unless it is ready.

    `mixes` tells of every mixed list that was found on the way, those that were put right among them; `is_critical` whether one is still
    there, or may be. `left_alone` tells what of the vehicle's own was kept beside the load, `left_sha256` names these
    lists, by kind (see wire.onboard_sha256).
    """

    state: SyncState
    code: str
    why: tuple[Reason, ...]
    sha256: str = ""
    is_critical: bool = False
    mixes: tuple[Mix, ...] = ()
    differences: tuple[ItemDifference, ...] = ()
    left_alone: tuple[Reason, ...] = ()
    left_sha256: Mapping[MissionType, str] = field(default_factory=dict)


@dataclass(frozen=True)
class SyncProgress:
    """Of the list that is under way; `stage` is reading, sending, clearing or restoring."""

    kind: MissionType
    stage: str
    done: int
    total: int
