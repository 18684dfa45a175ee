"""Meaning of an autopilot's modes, by their names in reports."""

from enum import StrEnum


class ModeKind(StrEnum):
    MISSION = "mission"
    HOLD = "hold"
    RETURN = "return"
    LAND = "land"
    TAKE_OFF = "take-off"
    GUIDED = "guided"
    BY_HAND = "by-hand"


_NAMES = {
    ModeKind.MISSION: ("MISSION", "AUTO"),
    ModeKind.HOLD: ("LOITER", "HOLD", "BRAKE", "POSHOLD", "READY"),
    ModeKind.RETURN: ("RTL", "RETURN", "SMART_RTL", "AUTO_RTL"),
    ModeKind.LAND: ("LAND", "PRECLAND", "LANDING"),
    ModeKind.TAKE_OFF: ("TAKEOFF", "TAKE-OFF"),
    ModeKind.GUIDED: ("GUIDED", "OFFBOARD", "GUIDED_NOGPS"),
    ModeKind.BY_HAND: (
        "MANUAL", "ALTCTL", "POSCTL", "ACRO", "STABILIZED", "STABILIZE", "RATTITUDE", "ALT_HOLD", "CIRCLE", "DRIFT", "SPORT", "FLIP",
        "AUTOTUNE", "THROW", "FLOWHOLD", "FOLLOW", "ZIGZAG", "SYSTEMID", "AUTOROTATE", "AVOID_ADSB",
    ),
}  # fmt: skip
_KINDS = {name: kind for kind, names in _NAMES.items() for name in names}


def mode_kind(mode: str) -> ModeKind | None:
    """Return the kind of a mode; None if unreported or unknown, as a companion may use its own names. MAVROS uses AUTO.MISSION."""
    name = mode.strip().upper().removeprefix("AUTO.")
    return ModeKind.BY_HAND if name.startswith("MODE ") else _KINDS.get(name)


RETURN_ALONG = "return along the route"  # by the rest of the onboard list

# Modes that one of our commands leads to.
LEADS_TO: dict[str, frozenset[ModeKind]] = {
    "arm": frozenset(ModeKind),
    "take-off": frozenset({ModeKind.TAKE_OFF, ModeKind.HOLD, ModeKind.GUIDED, ModeKind.MISSION}),
    "start": frozenset({ModeKind.MISSION, ModeKind.TAKE_OFF}),
    "resume": frozenset({ModeKind.MISSION}),
    "pause": frozenset({ModeKind.HOLD, ModeKind.GUIDED}),
    "hold": frozenset({ModeKind.HOLD, ModeKind.GUIDED}),
    "return": frozenset({ModeKind.RETURN, ModeKind.LAND}),
    RETURN_ALONG: frozenset({ModeKind.MISSION, ModeKind.LAND}),
    "land": frozenset({ModeKind.LAND}),
    "abort": frozenset({ModeKind.RETURN, ModeKind.LAND}),
}
WITHOUT_ORDER = frozenset({ModeKind.MISSION, ModeKind.TAKE_OFF})
FLY_LIST = frozenset({"start", "resume", "take-off", "arm", RETURN_ALONG})  # commands after which it flies its mission
AT_THE_END = frozenset({ModeKind.MISSION, ModeKind.HOLD, ModeKind.LAND, ModeKind.RETURN})
