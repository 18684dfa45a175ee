"""Kinds of UAV commands: urgency, axis, and how long each remains worth delivering."""

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
    """State of a UAV that commands set. Of two commands on one axis only the later counts."""

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
THEN_RETURN = "then_return"  # a command's parameter: its UAV returns once the command is done
WAIT_S = "wait_s"  # a return's parameter: seconds to hold first
HEIGHT_M = "height_m"  # a return's parameter: height above the take-off, set on the UAV before it returns
ALONG_ROUTE = "along_route"  # a return's parameter: along the rest of the approved route instead of straight
HAND_OVER = "hand_over"  # a command's parameter: a step of a route swap
SETS_IN_MOTION = frozenset({"arm", "take-off", "start", "resume"})


def priority_of(kind: str) -> int:
    return PRIORITIES[kind]


def axis_of(kind: str) -> Axis:
    return AXES.get(kind, Axis.FLIGHT)


def axes_overtaken_by(kind: str) -> tuple[Axis, ...]:
    """Return the axes on which a command of this kind expires unfinished commands. An abort covers all axes."""
    return tuple(Axis) if kind == "abort" else (axis_of(kind),)


def may_overtake(kind: str, unfinished: str) -> bool:
    """Whether a command of this kind may replace an unfinished one. A safety command is replaced only by one of at least the same rank.

    A hold does not cancel an earlier abort that waits for its link. Of the commands that set a UAV in motion only `resume` replaces a
    pause.
    """
    if unfinished == "pause" and kind in SETS_IN_MOTION:
        return kind == "resume"
    return SAFETY_RANKS.get(kind, 0) >= SAFETY_RANKS.get(unfinished, 0)


@dataclass(frozen=True)
class CommandLifetimes:
    """Seconds for which an undelivered command remains valid; None: until another command replaces it.

    Commands that set a UAV in motion expire soonest: nobody may be watching the UAV later. Commands that stop or return it last longer,
    but not until its next flight. A mission may wait until its UAV is switched on. Clearing a mission stays valid until the UAV connects
    again.
    """

    motion_s: float = 30.0  # arm, take off, start, resume
    stop_s: float = 600.0  # pause, hold, return, land, abort
    upload_s: float = 3_600.0  # also for a return height
    speed_s: float = 60.0
    read_back_s: float = 120.0  # added to a start or resume while the UAV's mission is read back before it

    def wanted_for_s(self, kind: str) -> float | None:
        if kind == "clear-mission":
            return None
        if kind in ("upload-mission", "set-return-height"):
            return self.upload_s
        if kind == "change-speed":
            return self.speed_s
        return self.motion_s if kind in SETS_IN_MOTION else self.stop_s
