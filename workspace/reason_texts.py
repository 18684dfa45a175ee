"""Texts of reasons in the user's language, and reasons in columns of the database.

A column of reasons, {"text": their English, "reasons": [...]}, stands beside one of text, which the version before shows. Where the text is
another one by now, that version wrote it, and the reasons count no more.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from django.utils.translation import gettext, ngettext

from operation.reasons import Reason, Why, Wording, english, reason_from_json, reasons_of
from workspace.locale_negotiation import number_text

WORDING = Wording(gettext, ngettext, number_text)  # of the language that is active when a text is made


def reason_text(reason: Reason | str) -> str:
    return reason if isinstance(reason, str) else reason.text(WORDING)


def why_text(why: Sequence[Mapping[str, Any]], stored: str, separator: str = " ") -> str:
    """The text of reasons as JSON has them; `stored`, in English, where there are none or one is not known any more, or not yet."""
    try:
        return separator.join(reason_text(reason_from_json(reason)) for reason in why) or stored
    except (KeyError, TypeError, ValueError):
        return stored


def message_json(why: Why) -> dict[str, Any]:
    """A message in English and its reasons, for a JSON that is stored."""
    return {"message": english(why), "why": [reason.to_json() for reason in reasons_of(why)]}


def with_message(entry: Mapping[str, Any]) -> dict[str, Any]:
    """A stored JSON that has a message, with it in the reader's language."""
    return {**entry, "message": why_text(entry.get("why", ()), str(entry.get("message", "")))}


def text_and_column(why: Why, max_length: int, separator: str = " ") -> tuple[str, dict[str, Any] | None]:
    """What is stored in the column of text and in that of reasons, which is empty where somebody else wrote the text."""
    text, reasons = english(why, separator)[:max_length], [reason.to_json() for reason in reasons_of(why)]
    return text, {"text": text, "reasons": reasons} if reasons else None


def reasons_of_column(column: Mapping[str, Any] | None, stored: str) -> list[dict[str, Any]]:
    """The reasons as JSON; none where the text beside them was stored without any."""
    return column["reasons"] if column and column["text"] == stored else []


def column_text(column: Mapping[str, Any] | None, stored: str, separator: str = " ") -> str:
    return why_text(reasons_of_column(column, stored), stored, separator)


def why_of_column(column: Mapping[str, Any] | None, stored: str) -> Why:
    """What is stored, to be stored elsewhere."""
    try:
        return [reason_from_json(reason) for reason in reasons_of_column(column, stored)] or stored
    except (KeyError, TypeError):  # of another version
        return stored
