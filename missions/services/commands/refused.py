"""Why something is not done that was asked for: reasons with a code for programs and a sentence for people."""

from collections.abc import Sequence
from dataclasses import dataclass

from operation.reasons import Reason, Why
from workspace.reason_texts import reason_text


@dataclass(frozen=True)
class RefusalReason:
    """`uav` is a place in the mission, where it is about one UAV. `why` is the message as it is stored: as a reason where it has a code."""

    code: str
    message: str
    uav: int | None = None
    reason: Reason | None = None

    @property
    def why(self) -> Why:
        return self.reason or self.message


class Refused(Exception):
    """It cannot be done as things are; `reasons` has at least one."""

    def __init__(self, reasons: Sequence[RefusalReason]) -> None:
        super().__init__(" ".join(reason.message for reason in reasons))
        self.reasons = tuple(reasons)


def refuse(code: str, message: str | Reason, uav: int | None = None) -> Refused:
    return Refused([RefusalReason(code, reason_text(message), uav, message if isinstance(message, Reason) else None)])


def refuse_for(reasons: Sequence[RefusalReason]) -> None:
    """Raises Refused where there is any."""
    if reasons:
        raise Refused(reasons)
