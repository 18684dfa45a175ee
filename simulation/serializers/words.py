"""Sentences of an assessment in the reader's language, made on reading from its stored codes and values."""

from collections.abc import Mapping
from typing import Any

from django.utils.formats import get_format
from django.utils.translation import gettext as _
from django.utils.translation import gettext_noop

from simulation.serializers.places import WaypointPlaces
from workspace.reason_texts import why_text

# Sentences of findings by code; values are inserted as formatted text.
SENTENCES = {
    "crashed": gettext_noop("%(name)s crashed%(flight)s. %(said)s"),
    "unfinished": gettext_noop("%(name)s did not come to the end of its flight%(flight)s. %(said)s"),
    "refused": gettext_noop("%(name)s did not take off%(flight)s. %(said)s"),
    "not-begun": gettext_noop("%(name)s did not begin flight %(number)s: the one before it did not end well."),
    "begun-in-air": gettext_noop("begins in the air; here it took off by itself first, with a battery as full as the conditions say"),
    "wind": gettext_noop("wind of %(wind)s m/s at %(agl)s m, it flies %(limit)s m/s through the air at most"),
    "reserve": gettext_noop("%(percent)s %% battery at return%(flight)s, limit %(limit)s %%"),
    "reserve-near": gettext_noop("%(percent)s %% battery at return%(flight)s, little above the limit of %(limit)s %%"),
    "across": gettext_noop("missed its route near %(place)s by %(metres)s m (allowed: %(limit)s m)"),
    "height": gettext_noop("missed its height near %(place)s by %(metres)s m (allowed: %(limit)s m)"),
    "not-flown-to": gettext_noop("%(place)s was not flown to"),
    "missed": gettext_noop("passed %(place)s at %(metres)s m (allowed: %(limit)s m)"),
    "passed-wide": gettext_noop("passed %(place)s at %(metres)s m (usual: %(limit)s m)"),
    "not-held": gettext_noop("stayed %(held)s s of %(hold)s s"),
    "late": gettext_noop("%(seconds)s s late at %(place)s (allowed: %(limit)s s)"),
    "early": gettext_noop("%(seconds)s s early at %(place)s (allowed: %(limit)s s)"),
    "zone-entered": gettext_noop("inside the active %(zone)s zone near %(place)s"),
    "zone-near": gettext_noop("%(metres)s m from the %(zone)s zone (minimum %(limit)s m)"),
    "low": gettext_noop("%(metres)s m above the ground near %(place)s (minimum %(limit)s m)"),
    "obstacle": gettext_noop("%(metres)s m from a tower or wire near %(place)s (minimum %(limit)s m)"),
    "obstacle-column": gettext_noop("takes off or lands %(metres)s m from a tower or wire (minimum %(limit)s m)"),
    "apart": gettext_noop("%(metres)s m from %(other)s in the air (minimum %(limit)s m)"),
}
DIGITS = {"metres": 1, "limit": 0, "percent": 0, "seconds": 0, "held": 0, "hold": 0, "wind": 1, "agl": 0}
LIMITS = ("limit_m", "limit_percent", "limit_s", "limit_mps")


def reason_of(finding: Mapping[str, Any], names: Mapping[int, str], places: WaypointPlaces) -> str:
    """Return the sentence of a finding; `names` are those of UAVs by place, `places` those of waypoints."""
    facts = dict(finding["facts"])
    facts["limit"] = next((facts[name] for name in LIMITS if name in facts), None)
    facts["held"], facts["hold"] = facts.get("held_s"), facts.get("hold_s")
    facts["wind"], facts["agl"] = facts.get("wind_mps"), facts.get("agl_m")
    facts["number"] = facts.get("flight")
    facts["other"] = names.get(facts.get("other", -1), "")
    said_why = facts.pop("said_why", None)
    facts["said"] = why_text([said_why] if said_why else [], str(facts.get("said") or ""))
    several = (facts.get("flights") or 1) > 1
    facts["flight"] = f" ({_('flight %(number)s') % {'number': facts['number']}})" if several else ""
    facts["place"] = places.get((finding.get("uav", -1), facts.get("waypoint", -1))) or _numbered(facts.get("waypoint"))
    shown = {name: _shown(name, value) for name, value in facts.items()}
    sentence = SENTENCES.get(finding["code"])
    return str(finding["code"]) if sentence is None else (_(sentence) % shown).strip()


def render_finding(
    finding: Mapping[str, Any], names: Mapping[int, str], labels: Mapping[int, str], places: WaypointPlaces
) -> dict[str, Any]:
    """Return the finding with its sentence, after its subject: the target by number and name, else the UAV."""
    target = finding["target"]
    about = names.get(finding["uav"], "")
    if target is not None:
        about = _("target %(number)s") % {"number": target + 1}
        about = f"{about} {labels[target]}" if labels.get(target) else about
    reason = reason_of(finding, names, places)
    whole = reason if finding["code"] in ("crashed", "unfinished", "refused", "not-begun") else f"{about}: {reason}"
    facts = finding["facts"]
    return {
        **{name: finding[name] for name in ("level", "code", "uav", "target")},
        "reason": reason,
        "message": whole,
        "waypoint": facts.get("waypoint"),
        "short_percent": _short_percent(finding["code"], facts),
    }


def _short_percent(code: str, facts: Mapping[str, Any]) -> float | None:
    """Return how much battery is missing at the end, in percent."""
    percent, limit = facts.get("percent"), facts.get("limit_percent")
    return round(limit - percent, 1) if code == "reserve" and percent is not None and limit is not None else None


def _numbered(waypoint: int | None) -> str:
    """Return a place of a plan that is gone: the waypoint by its number, counted from 1."""
    return "–" if waypoint is None or waypoint < 0 else _("waypoint %(number)s") % {"number": waypoint + 1}


def _shown(name: str, value: Any) -> Any:
    if isinstance(value, float) and name in DIGITS:
        text = f"{value:.{DIGITS[name]}f}"
        return text.replace(".", get_format("DECIMAL_SEPARATOR"))
    return value
