"""The states of a finding and the steps between them."""

from enum import StrEnum


class FindingState(StrEnum):
    OPEN = "open"
    WORK_ORDERED = "work_ordered"
    DONE = "done"  # a user says so
    VERIFIED = "verified"  # a later visit looked and did not see it
    REJECTED = "rejected"  # it is no defect


BY_USERS = {
    FindingState.OPEN: {FindingState.WORK_ORDERED, FindingState.DONE, FindingState.REJECTED},
    FindingState.WORK_ORDERED: {FindingState.OPEN, FindingState.DONE, FindingState.REJECTED},
    FindingState.DONE: {FindingState.OPEN, FindingState.WORK_ORDERED},
    FindingState.VERIFIED: {FindingState.OPEN},
    FindingState.REJECTED: {FindingState.OPEN},
}
UNRESOLVED = frozenset({FindingState.OPEN, FindingState.WORK_ORDERED, FindingState.DONE})


def may_set(present: FindingState, wanted: FindingState) -> bool:
    """Whether a user may set this state. VERIFIED follows from an observation alone."""
    return wanted == present or wanted in BY_USERS[present]


def after_observation(present: FindingState, *, is_seen: bool) -> FindingState:
    """Return the state after a later visit has looked: done and not seen is verified, seen again is open again."""
    if present == FindingState.DONE and not is_seen:
        return FindingState.VERIFIED
    return FindingState.OPEN if is_seen and present in (FindingState.DONE, FindingState.VERIFIED) else present
