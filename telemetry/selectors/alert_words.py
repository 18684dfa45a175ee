"""Texts of alerts in the reader's language. Stored are an English template and its values."""

from collections.abc import Mapping, Sequence
from typing import Any

from django.utils.translation import gettext as _
from django.utils.translation import gettext_noop

from missions.models import UavCommand
from operation.reasons import Reason, english
from workspace.reason_texts import reasons_of_column, why_text

# Texts of detectors, listed here for the catalogues.
TEMPLATES = (
    gettext_noop("%(uav)s: no telemetry for %(seconds)s s."),
    gettext_noop("Link to %(uav)s lost: no telemetry for %(seconds)s s."),
    gettext_noop("%(uav)s is %(metres)s m beside its route; %(limit)s m are allowed."),
    gettext_noop("%(uav)s is %(metres)s m off its route beside wires; %(limit)s m are allowed."),
    gettext_noop("%(uav)s flies %(metres)s m above the height of its route; %(limit)s m are allowed."),
    gettext_noop("%(uav)s flies %(metres)s m below the height of its route; %(limit)s m are allowed."),
    gettext_noop("%(uav)s is in the no-fly zone %(zone)s."),
    gettext_noop("%(uav)s will be in the no-fly zone %(zone)s in %(seconds)s s."),
    gettext_noop("%(uav)s: battery %(percent)s %%, just enough to return (%(home)s %%) with the reserve of %(reserve)s %%."),
    gettext_noop("%(uav)s is expected to land with %(percent)s %% of its battery (reserve %(reserve)s %%)."),
    gettext_noop("The battery of %(uav)s is not enough for its route: it would be empty before the end."),
    gettext_noop("%(uav)s: battery %(percent)s %%, below the reserve of %(reserve)s %%."),
    gettext_noop("%(uav)s: battery %(percent)s %%, below the reserve of %(reserve)s %% within a minute."),
    gettext_noop("%(uav)s: battery %(percent)s %%, not enough to return (%(home)s %%)."),
    gettext_noop("%(uav)s: battery %(percent)s %%, after a return (%(home)s %%) hardly any would be left."),
    gettext_noop(
        "%(uav)s: battery %(percent)s %%, not enough to return home (%(home)s %%). The landing place %(metres)s m away is in reach."
    ),
    gettext_noop("%(uav)s flies its route, but has not come on for %(seconds)s s."),
    gettext_noop(
        "%(uav)s and %(other)s: %(metres)s m apart, %(height)s m in height, closing at %(speed)s m/s (±%(bound)s m),"
        " closest in %(seconds)s s."
        " Hold %(hold)s: %(why)s."
    ),
    gettext_noop("%(uav)s and %(other)s: %(metres)s m apart, %(height)s m in height (±%(bound)s m). Hold %(hold)s: %(why)s."),
    gettext_noop("%(uav)s is returning (%(mode)s): failsafe or pilot, not commanded from here."),
    gettext_noop("%(uav)s is landing (%(mode)s): failsafe or pilot, not commanded from here."),
    gettext_noop("%(uav)s is under other control (mode %(mode)s): pilot or another ground station."),
    gettext_noop("%(uav)s has stopped its mission (%(mode)s), not commanded from here."),
    gettext_noop("%(uav)s has resumed its mission (%(mode)s), not commanded from here."),
    gettext_noop("%(uav)s: no GPS fix. %(own)s"),
    gettext_noop("%(uav)s: telemetry without position. %(own)s"),
    gettext_noop("The position of %(uav)s has jumped by %(metres)s m."),
    gettext_noop("%(uav)s sees %(satellites)s satellites only."),
    gettext_noop("The position of %(uav)s is weak: its HDOP is %(hdop)s."),
    gettext_noop("%(uav)s flies a mission that is not the approved one."),
    gettext_noop("%(uav)s flies a mission, and nobody knows which: nothing approved was found on it."),
    gettext_noop("%(uav)s may hold another mission than the approved one: it changed after it was read back."),
    gettext_noop("%(uav)s is at item %(item)s of its mission; the approved one has %(items)s."),
    gettext_noop("Wind %(wind)s m/s at %(uav)s (limit %(limit)s m/s)."),
    gettext_noop("%(uav)s is returning (%(mode)s), not commanded from here. Autopilot: %(words)s"),
    gettext_noop("%(uav)s is landing (%(mode)s), not commanded from here. Autopilot: %(words)s"),
    gettext_noop("%(uav)s is under other control (mode %(mode)s). Autopilot: %(words)s"),
    gettext_noop("%(uav)s has stopped its mission (%(mode)s), not commanded from here. Autopilot: %(words)s"),
    gettext_noop("%(uav)s has resumed its mission (%(mode)s), not commanded from here. Autopilot: %(words)s"),
    gettext_noop("%(uav)s itself reports its battery as %(state)s."),
    gettext_noop("%(uav)s itself reports its battery as %(state)s: %(words)s"),
    gettext_noop(
        "%(uav)s is on the ground %(metres)s m from where its flight begins or ends, last at %(place)s:"
        " it has crashed, or landed by itself."
    ),
    gettext_noop("%(uav)s was not started: another list than the approved one is on board. %(words)s"),
    gettext_noop("%(uav)s holds a mix of missions. %(words)s"),
    gettext_noop("The UAV %(uav)s holds something else than what was approved."),
    gettext_noop("The UAV %(uav)s does not say what it holds."),
    gettext_noop(
        "%(uav)s is held and was to fly on with %(mission)s, but a step failed: %(step)s. %(words)s"
        " Send it its mission again and start it, or tell it to return."
    ),
    gettext_noop("No return was sent to %(uav)s, which goes on as before: its return height is not set. %(words)s"),
    gettext_noop("No return was sent to %(uav)s, which goes on as before: it was to hold first. %(words)s"),
    gettext_noop("%(uav)s does not return along its route, and goes on as before. %(words)s"),
    gettext_noop("%(uav)s was told to return, and does not. %(words)s"),
    gettext_noop("Two senders say that they are %(uav)s: %(believed)s, which is believed, and %(other)s."),
    gettext_noop(
        "The signed frames of %(uav)s come from two addresses, %(believed)s and %(other)s. Both are answered; one may belong to a listener."
    ),
)

REASONS = (
    gettext_noop("it climbs towards the other one"),
    gettext_noop("the other one stands still"),
    gettext_noop("it is behind"),
    gettext_noop("it is higher"),
    gettext_noop("it has the other one on its right"),
    gettext_noop("either can be held"),
)
OWN_ACTS = (
    gettext_noop("ArduPilot usually lands by itself within seconds (FS_EKF_ACTION) and drifts with the wind."),
    gettext_noop("PX4 usually descends by itself 5 s after it lost its position (EKF2_NOAID_TOUT) and drifts with the wind."),
    gettext_noop("What its autopilot does by itself is not known."),
)
ADVICES = (
    gettext_noop("A return lands with about %(landing)s %% of the battery, below the reserve of %(reserve)s %%."),
    gettext_noop(
        "A return leads to the landing place %(metres)s m away and lands there with about %(landing)s %% of the battery;"
        " home takes about %(home)s %%."
    ),
    gettext_noop("A return lands with about %(landing)s %% of the battery only: land here if the ground allows it."),
    gettext_noop("How much of the battery the return takes is not known."),
    gettext_noop("Return is not offered: it takes about %(home)s %% of the battery, and %(percent)s %% is left."),
    gettext_noop("Return is not offered: the UAV makes no headway against the wind."),
    gettext_noop("It lands with about %(landing)s %% of the battery (reserve %(reserve)s %%)."),
    gettext_noop("Its battery does not last for the return, which takes about %(home)s %%: %(percent)s %% is left."),
    gettext_noop("Planned for link loss: it continues its mission by itself. %(failsafe)s"),
    gettext_noop("Planned for link loss: it holds for %(seconds)s s, then returns. %(failsafe)s"),
    gettext_noop("Planned for link loss: it returns. %(failsafe)s"),
    gettext_noop("It was returning when last heard, and should continue by itself."),
    gettext_noop("It was landing when last heard, and should continue by itself."),
    gettext_noop("It was holding when last heard: it holds until its failsafe or its battery ends that."),
    gettext_noop("It was under other control when last heard (mode %(mode)s): ask the pilot."),
    gettext_noop("What it does by itself is not known."),
    gettext_noop("The failsafe set on the autopilot (FS_GCS_ENABLE, FS_THR_ENABLE) comes first."),
    gettext_noop("The failsafe set on the autopilot (NAV_DLL_ACT, NAV_RCL_ACT) comes first."),
    gettext_noop("A failsafe set on the UAV comes first."),
)
WORDS_WHY = "words_why"
TRANSLATED_VALUES = ("step", "state", "why", "own", "failsafe")
STATES = (gettext_noop("low"), gettext_noop("critical"), gettext_noop("emergency"), gettext_noop("failed"), gettext_noop("unhealthy"))


def why_values(why: Sequence[Reason]) -> dict[str, Any]:
    """Return the values of an alert that quotes reasons: `words` in English, and the reasons."""
    return {"words": english(why), WORDS_WHY: [reason.to_json() for reason in why]}


def outcome_values(command: UavCommand) -> dict[str, Any]:
    """Return the values of an alert that quotes the outcome of a command."""
    return {"words": command.outcome, WORDS_WHY: reasons_of_column(command.outcome_why, command.outcome)}


def alert_words(message: str, values: Mapping[str, Any]) -> str:
    """Return the text. A message without values, or with values that do not fit, is returned as stored."""
    if not values:
        return message
    read = {
        name: why_text(values.get(WORDS_WHY, ()), value) if name == "words" else _(value) if name in TRANSLATED_VALUES else value
        for name, value in values.items()
    }
    try:
        return _(message) % read
    except (KeyError, TypeError, ValueError):
        return message
