"""Texts of reasons in the user's language, and reasons in columns of the database.

A column of reasons, {"text": their English, "reasons": [...]}, accompanies a text column, which the previous version shows. If the text
column differs, that version wrote it, and the reasons are ignored.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from django.utils.translation import gettext, ngettext

from operation.reasons import Reason, Why, Wording, english, reason_from_json, reasons_of
from workspace.locale_negotiation import number_text

WORDING = Wording(gettext, ngettext, number_text)  # of the language active when a text is made


def reason_text(reason: Reason | str) -> str:
    return reason if isinstance(reason, str) else reason.text(WORDING)


def why_text(why: Sequence[Mapping[str, Any]], stored: str, separator: str = " ") -> str:
    """Return the text of reasons given as JSON; `stored`, in English, where there are none or one is unknown to this version."""
    try:
        return separator.join(reason_text(reason_from_json(reason)) for reason in why) or stored
    except (KeyError, TypeError, ValueError):
        return stored


def message_json(why: Why) -> dict[str, Any]:
    """Return a message in English and its reasons, for stored JSON."""
    return {"message": english(why), "why": [reason.to_json() for reason in reasons_of(why)]}


def with_message(entry: Mapping[str, Any]) -> dict[str, Any]:
    """Return a stored JSON entry with its message in the reader's language."""
    return {**entry, "message": why_text(entry.get("why", ()), str(entry.get("message", "")))}


def text_and_column(why: Why, max_length: int, separator: str = " ") -> tuple[str, dict[str, Any] | None]:
    """Return the values of the text column and of the reasons column, which is None for a text without reasons."""
    text, reasons = english(why, separator)[:max_length], [reason.to_json() for reason in reasons_of(why)]
    return text, {"text": text, "reasons": reasons} if reasons else None


def reasons_of_column(column: Mapping[str, Any] | None, stored: str) -> list[dict[str, Any]]:
    """Return the reasons as JSON; none where the text column was stored without them."""
    return column["reasons"] if column and column["text"] == stored else []


def column_text(column: Mapping[str, Any] | None, stored: str, separator: str = " ") -> str:
    return why_text(reasons_of_column(column, stored), stored, separator)


def why_of_column(column: Mapping[str, Any] | None, stored: str) -> Why:
    """Return what is stored, to be stored elsewhere."""
    try:
        return [reason_from_json(reason) for reason in reasons_of_column(column, stored)] or stored
    except (KeyError, TypeError):  # written by another version
        return stored
