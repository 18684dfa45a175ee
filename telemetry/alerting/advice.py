"""Advice beside an alert: the cost of an act or why it is not offered, and what the UAV does by itself.

Templates are English; values are inserted when shown, in the reader's language (selectors/alert_words.py).
"""

from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

from telemetry.alerting.detection import LAND, RETURN
from telemetry.alerting.modes import LEADS_TO, ModeKind
from telemetry.alerting.surroundings import IssuedOrder

ADVICE, OWN_ACT = "advice", "own_act"  # in the details of an alert

# Return, by what is left of the battery
LOW_RETURN = "A return lands with about %(landing)s %% of the battery, below the reserve of %(reserve)s %%."
TO_LANDING_PLACE = (
    "A return leads to the landing place %(metres)s m away and lands there with about %(landing)s %% of the battery;"
    " home takes about %(home)s %%."
)
TIGHT_RETURN = "A return lands with about %(landing)s %% of the battery only: land here if the ground allows it."
UNKNOWN_RETURN = "How much of the battery the return takes is not known."
NO_RETURN = "Return is not offered: it takes about %(home)s %% of the battery, and %(percent)s %% is left."
NO_HEADWAY = "Return is not offered: the UAV makes no headway against the wind."
COMES_DOWN_LOW = "It lands with about %(landing)s %% of the battery (reserve %(reserve)s %%)."
FALLS_SHORT = "Its battery does not last for the return, which takes about %(home)s %%: %(percent)s %% is left."

# What a UAV with a lost link does, by its last messages and its plan
GOES_ON = "Planned for link loss: it continues its mission by itself. %(failsafe)s"
HOLDS_THEN_RETURNS = "Planned for link loss: it holds for %(seconds)s s, then returns. %(failsafe)s"
RETURNS_PLANNED = "Planned for link loss: it returns. %(failsafe)s"
WAS_RETURNING = "It was returning when last heard, and should continue by itself."
WAS_LANDING = "It was landing when last heard, and should continue by itself."
WAS_HOLDING = "It was holding when last heard: it holds until its failsafe or its battery ends that."
WAS_FLOWN = "It was under other control when last heard (mode %(mode)s): ask the pilot."
NOT_PLANNED = "What it does by itself is not known."
FAILSAFE_ARDUPILOT = "The failsafe set on the autopilot (FS_GCS_ENABLE, FS_THR_ENABLE) comes first."
FAILSAFE_PX4 = "The failsafe set on the autopilot (NAV_DLL_ACT, NAV_RCL_ACT) comes first."
FAILSAFE_UNKNOWN = "A failsafe set on the UAV comes first."
FAILSAFES = {"ardupilot": FAILSAFE_ARDUPILOT, "px4": FAILSAFE_PX4}

_COMES_DOWN_BY = {ModeKind.RETURN: RETURN, ModeKind.LAND: LAND}


def advice(template: str, **values: object) -> dict[str, Any]:
    """Return advice in the form of an alert's details."""
    return {ADVICE: {"message": template, "values": values}}


def own_act(mode: ModeKind | None, since_s: float | None, order: IssuedOrder | None) -> dict[str, Any]:
    """Return what a UAV in this mode does by itself, in the form of an alert's details; empty unless it returns or lands.

    since_s: when it was first reported in this mode; None: it was in it at its first message.
    """
    kind = None if mode is None else _COMES_DOWN_BY.get(mode)
    if kind is None:
        return {}
    since = None if since_s is None else datetime.fromtimestamp(since_s, UTC).isoformat(timespec="seconds")
    is_commanded = order is not None and order.done_s is not None and mode in LEADS_TO.get(order.kind, ())
    return {OWN_ACT: {"kind": kind, "since": since, "is_commanded": is_commanded}}


def answer_of(details: Mapping[str, Any]) -> tuple[Any, ...]:
    """Return the parts of an alert's details that affect an operator's decision, without values that change each second."""
    status_texts = details.get(ADVICE) or {}
    return details.get("acts"), details.get(OWN_ACT), status_texts.get("message")


def figures_of(details: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the values of an alert's advice; empty without advice."""
    values: Mapping[str, Any] = (details.get(ADVICE) or {}).get("values") or {}
    return values
