"""Why something is not done that was asked for: reasons with a code for programs and a sentence for people."""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class RefusalReason:
    """`uav` is a place in the mission, where it is about one UAV."""

    code: str
    message: str
    uav: int | None = None


class Refused(Exception):
    """It cannot be done as things are; `reasons` has at least one."""

    def __init__(self, reasons: Sequence[RefusalReason]) -> None:
        super().__init__(" ".join(reason.message for reason in reasons))
        self.reasons = tuple(reasons)


def refuse(code: str, message: str, uav: int | None = None) -> Refused:
    return Refused([RefusalReason(code, message, uav)])


def refuse_for(reasons: Sequence[RefusalReason]) -> None:
    """Raises Refused where there is any."""
    if reasons:
        raise Refused(reasons)
