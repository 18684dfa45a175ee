"""How a transfer ended."""

from dataclasses import dataclass
from enum import StrEnum

from pymavlink.dialects.v20 import ardupilotmega as mavlink

# Acknowledgements that do not tell whether the transfer goes on: a repeated message draws them, too, or the vehicle is busy.
UNCERTAIN = frozenset({
    mavlink.MAV_MISSION_ERROR,
    mavlink.MAV_MISSION_DENIED,
    mavlink.MAV_MISSION_INVALID_SEQUENCE,
    mavlink.MAV_MISSION_OPERATION_CANCELLED,
})  # fmt: skip


class TransferState(StrEnum):
    DONE = "done"
    REFUSED = "refused"  # by the vehicle, which said why
    UNSURE = "unsure"  # all was sent, and the last answer tells nothing
    SILENT = "silent"
    CANCELLED = "cancelled"


@dataclass(frozen=True)
class TransferOutcome:
    """`code` is short and stable, `item` the one at which it ended, as counted on the wire."""

    state: TransferState
    code: str = ""
    item: int | None = None
