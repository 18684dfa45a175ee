"""Texts of reasons in the user's language, and reasons in columns of the database.

A column of reasons, {"text": their English, "reasons": [...]}, stands beside one of text, which the version before shows. Where the text is
another one by now, that version wrote it, and the reasons count no more.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from django.utils.translation import gettext, ngettext

from operation.reasons import Reason, Why, Wording, english, reason_from_json
from workspace.locale_negotiation import number_text

WORDING = Wording(gettext, ngettext, number_text)  # of the language that is active when a text is made


def reason_text(reason: Reason | str) -> str:
    return reason if isinstance(reason, str) else reason.text(WORDING)


def why_text(why: Sequence[Mapping[str, Any]], stored: str) -> str:
    """The text of reasons as JSON has them; `stored`, in English, where there are none or one is not known any more, or not yet."""
    try:
        return " ".join(reason_text(reason_from_json(reason)) for reason in why) or stored
    except (KeyError, TypeError, ValueError):
        return stored


def text_and_column(why: Why, max_length: int) -> tuple[str, dict[str, Any] | None]:
    """What is stored in the column of text and in that of reasons, which is empty where somebody else wrote the text."""
    text = english(why)[:max_length]
    return text, None if isinstance(why, str) or not why else {"text": text, "reasons": [reason.to_json() for reason in why]}


def reasons_of_column(column: Mapping[str, Any] | None, stored: str) -> list[dict[str, Any]]:
    """The reasons as JSON; none where the text beside them was stored without any."""
    return column["reasons"] if column and column["text"] == stored else []


def column_text(column: Mapping[str, Any] | None, stored: str) -> str:
    return why_text(reasons_of_column(column, stored), stored)
