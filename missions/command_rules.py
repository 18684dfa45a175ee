"""What kinds of commands there are to a UAV: how urgent, about what, and how long each is worth delivering."""

from dataclasses import dataclass
from enum import StrEnum

SAFETY, PAUSE, MISSION, PARAMETER = range(4)  # the smaller goes first

PRIORITIES = {
    "abort": SAFETY,
    "hold": SAFETY,
    "return": SAFETY,
    "land": SAFETY,
    "pause": PAUSE,
    "resume": PAUSE,
    "upload-mission": MISSION,
    "clear-mission": MISSION,
    "arm": MISSION,
    "take-off": MISSION,
    "start": MISSION,
    "change-speed": PARAMETER,
    "set-return-height": PARAMETER,
}


class Axis(StrEnum):
    """What a command sets. Of two commands about the same thing only the later one counts."""

    FLIGHT = "flight"
    MISSION = "mission"
    SPEED = "speed"
    PARAMETER = "parameter"


AXES = {
    "upload-mission": Axis.MISSION,
    "clear-mission": Axis.MISSION,
    "change-speed": Axis.SPEED,
    "set-return-height": Axis.PARAMETER,
}
SAFETY_RANKS = {"hold": 1, "return": 2, "land": 3, "abort": 4}
THEN_RETURN = "then_return"  # a command's parameter: once it is done its UAV is told to return
WAIT_S = "wait_s"  # a return's parameter: after so many seconds of holding
HEIGHT_M = "height_m"  # of a return: above the take-off, set on the UAV before it
ALONG_ROUTE = "along_route"  # a return's parameter: by the rest of its approved route, not straight
HAND_OVER = "hand_over"  # a command's parameter: a step of giving its UAV another route
SETS_IN_MOTION = frozenset({"arm", "take-off", "start", "resume"})


def priority_of(kind: str) -> int:
    return PRIORITIES[kind]


def axis_of(kind: str) -> Axis:
    return AXES.get(kind, Axis.FLIGHT)


def axes_overtaken_by(kind: str) -> tuple[Axis, ...]:
    """About which an unfinished command no longer counts once one of this kind is given: an abort is about everything."""
    return tuple(Axis) if kind == "abort" else (axis_of(kind),)


def may_overtake(kind: str, unfinished: str) -> bool:
    """Whether one of this kind takes the place of an unfinished one: of what makes a UAV safe only what does so as firmly.

    An abort that waits for its link is not called off by a hold that is given after it. A pause is called off by going on, and by nothing
    else that moves a UAV.
    """
    if unfinished == "pause" and kind in SETS_IN_MOTION:
        return kind == "resume"
    return SAFETY_RANKS.get(kind, 0) >= SAFETY_RANKS.get(unfinished, 0)


@dataclass(frozen=True)
class CommandLifetimes:
    """For how long [s] a command that was not delivered is still wanted; None: until it is overtaken.

    What sets a UAV in motion is soon too old: nobody stands beside it any more. What stops it or brings it back is wanted longer, but not
    on its next flight. A mission may wait for its UAV to be switched on, and taking one off is wanted whenever the UAV is heard again.
    """

    motion_s: float = 30.0  # arm, take off, start, resume
    stop_s: float = 600.0  # pause, hold, return, land, abort
    upload_s: float = 3_600.0  # and a return height
    speed_s: float = 60.0
    read_back_s: float = 120.0  # by which a start or resume may be wanted longer, while what is on the UAV is read back before it

    def wanted_for_s(self, kind: str) -> float | None:
        if kind == "clear-mission":
            return None
        if kind in ("upload-mission", "set-return-height"):
            return self.upload_s
        if kind == "change-speed":
            return self.speed_s
        return self.motion_s if kind in SETS_IN_MOTION else self.stop_s
