"""Outcome of bringing a load onto a vehicle."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from mavlink.mission_sync.compare import ItemDifference
from mavlink.vehicle_plan import MissionType
from operation.reasons import Reason


class SyncState(StrEnum):
    READY = "ready"  # the vehicle holds what was approved
    INTACT = "intact"  # failed; all lists are as before
    CLEARED = "cleared"  # failed; the mission was cleared
    MIXED = "mixed"  # the vehicle holds an unapproved list that could not be cleared
    UNREAD = "unread"  # failed; the vehicle's lists could not be read


@dataclass(frozen=True)
class Mix:
    """A readback that matches neither the approved list nor the previous one."""

    kind: MissionType
    what: Reason


@dataclass(frozen=True)
class SyncOutcome:
    """`code` is the reason of a failure. `sha256` is the hash of the load that the vehicle holds; empty unless ready.

    `mixes` are all mixed lists found, including those repaired. `is_critical` is whether the vehicle holds one, or may hold one.
    `left_alone` describes lists of the vehicle that were kept beside the load; `left_sha256` are their hashes by kind (see
    wire.onboard_sha256).
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
    """Progress of the current list; `stage` is reading, sending, clearing or restoring."""

    kind: MissionType
    stage: str
    done: int
    total: int
