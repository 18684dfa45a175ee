"""Texts of the planner's reasons in the user's language."""

from collections.abc import Mapping, Sequence
from typing import Any

from django.utils.translation import get_language, gettext, ngettext

from planning.reasons import Reason, Wording, reason_from_json
from planning.request import InvalidRequest
from workspace.locale_negotiation import number_text

WORDING = Wording(gettext, ngettext, number_text)  # of the language that is active when a text is made


def reason_text(reason: Reason | str) -> str:
    return reason if isinstance(reason, str) else reason.text(WORDING)


def fault_texts(error: InvalidRequest) -> dict[str, str]:
    """What is wrong with a request, by place."""
    return {place: reason_text(fault) for place, fault in error.faults.items()}


def why_text(why: Sequence[Mapping[str, Any]], stored: str) -> str:
    """The text of reasons as a plan's JSON has them; `stored`, in English, where there are none or one is not known any more."""
    try:
        return " ".join(reason_text(reason_from_json(reason)) for reason in why) or stored
    except (KeyError, TypeError, ValueError):
        return stored


def with_texts(items: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Unassigned targets or warnings of a plan's JSON with their messages in the reader's language."""
    return [{**item, "message": why_text(item.get("why", ()), item["message"])} for item in items]


def plan_with_texts(plan: dict[str, Any]) -> dict[str, Any]:
    """A plan's JSON, whose messages are English, in the reader's language."""
    if (get_language() or "en").startswith("en"):
        return plan
    return {**plan, "warnings": with_texts(plan["warnings"]), "unassigned": with_texts(plan["unassigned"])}
