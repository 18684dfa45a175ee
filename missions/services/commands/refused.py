"""Refusals: reasons with a code for programs and a sentence for users."""

from collections.abc import Sequence
from dataclasses import dataclass

from operation.reasons import Reason, Why
from workspace.reason_texts import reason_text


@dataclass(frozen=True)
class RefusalReason:
    """One reason. `uav` is its place in the mission, if it concerns one UAV. `why` is the stored form of a reason with a code."""

    code: str
    message: str
    uav: int | None = None
    reason: Reason | None = None

    @property
    def why(self) -> Why:
        return self.reason or self.message


class Refused(Exception):
    """Raised when an action is not possible in the current state; `reasons` has at least one."""

    def __init__(self, reasons: Sequence[RefusalReason]) -> None:
        super().__init__(" ".join(reason.message for reason in reasons))
        self.reasons = tuple(reasons)


def refuse(code: str, message: str | Reason, uav: int | None = None) -> Refused:
    return Refused([RefusalReason(code, reason_text(message), uav, message if isinstance(message, Reason) else None)])


def refuse_for(reasons: Sequence[RefusalReason]) -> None:
    """Raise Refused where there is any reason."""
    if reasons:
        raise Refused(reasons)
