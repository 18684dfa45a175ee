"""Reasons of targets that were not inspected, and incidents, in the reader's language."""

from django.utils.translation import gettext as _
from django.utils.translation import gettext_noop

from telemetry.mission_report.outcomes import OutcomeReason
from workspace.reason_texts import why_text

WORDS = {
    "crashed": gettext_noop("%(uav)s crashed"),
    "crashed-cause": gettext_noop("%(uav)s crashed, %(cause)s"),
    "down": gettext_noop("%(uav)s is down %(metres)s m from where its flight begins or ends"),
    "failsafe-return": gettext_noop("%(uav)s returned by its failsafe or its pilot, not commanded from here"),
    "failsafe-return-cause": gettext_noop("%(uav)s returned by its failsafe, %(cause)s"),
    "failsafe-land": gettext_noop("%(uav)s landed by its failsafe or its pilot, not commanded from here"),
    "failsafe-land-cause": gettext_noop("%(uav)s landed by its failsafe, %(cause)s"),
    "told-return": gettext_noop("%(who)s told %(uav)s to return"),
    "told-return-why": gettext_noop("%(who)s told %(uav)s to return: %(why)s"),
    "told-land": gettext_noop("%(who)s told %(uav)s to land"),
    "told-land-why": gettext_noop("%(who)s told %(uav)s to land: %(why)s"),
    "aborted": gettext_noop("mission aborted by %(who)s"),
    "aborted-why": gettext_noop("mission aborted by %(who)s: %(why)s"),
    "battery": gettext_noop("%(uav)s was critically low on battery"),
    "link-lost": gettext_noop("%(uav)s lost its link"),
    "flight-failed": gettext_noop("%(uav)s reported that its flight failed"),
    "not-reached": gettext_noop("%(uav)s passed it at %(metres)s m"),
    "not-seen": gettext_noop("%(uav)s was not seen near it"),
    "not-held": gettext_noop("%(uav)s stayed %(held)s s of %(planned)s s"),
    "reported": gettext_noop("%(uav)s reported it as %(outcome)s"),
    "reported-note": gettext_noop("%(uav)s reported it as %(outcome)s: %(note)s"),
    "nearest-report": gettext_noop("nearest report %(metres)s m away"),
    "no-report": gettext_noop("no report near it"),
    "not-flown": gettext_noop("%(uav)s did not fly"),
    "not-planned": gettext_noop("not part of any route"),
    "continued": gettext_noop("left to the mission that continues this one"),
    "ended": gettext_noop("the mission ended before it was reached"),
}
CAUSES = {
    "motor": gettext_noop("motor"),
    "battery": gettext_noop("battery"),
    "position": gettext_noop("no position"),
    "link": gettext_noop("link lost"),
}
OUTCOMES = {"complete": gettext_noop("complete"), "skipped": gettext_noop("skipped"), "failed": gettext_noop("unsuccessful")}


def reason_words(reason: OutcomeReason) -> str:
    """Return part of a sentence, without the time at which it happened."""
    values = dict(reason.values)
    if reason.code == "stated":
        return why_text(values.get("why", ()), str(values["words"])).rstrip(".")  # a planner's sentence, inserted into another one
    if values.get("cause"):
        values["cause"] = _(CAUSES[values["cause"]])
    if values.get("outcome") in OUTCOMES:
        values["outcome"] = _(OUTCOMES[values["outcome"]])
    return _(WORDS[reason.code]) % values
