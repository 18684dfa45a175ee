"""Texts of the planner's reasons in the user's language."""

from collections.abc import Mapping, Sequence
from typing import Any

from django.utils.translation import get_language

from planning.request import InvalidRequest
from workspace.reason_texts import reason_text, why_text


def fault_texts(error: InvalidRequest) -> dict[str, str]:
    """Return the faults of a request as texts, by place."""
    return {place: reason_text(fault) for place, fault in error.faults.items()}


def with_texts(items: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Return unassigned targets or warnings of a plan's JSON with their messages in the reader's language."""
    return [{**item, "message": why_text(item.get("why", ()), item["message"])} for item in items]


def plan_with_texts(plan: dict[str, Any]) -> dict[str, Any]:
    """Return a plan's JSON, whose messages are English, in the reader's language."""
    if (get_language() or "en").startswith("en"):
        return plan
    return {**plan, "warnings": with_texts(plan["warnings"]), "unassigned": with_texts(plan["unassigned"])}
