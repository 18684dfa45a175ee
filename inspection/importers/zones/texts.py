"""Texts of a zone file: strings of bounded length."""

from typing import Any

from inspection.geodesy.geometry_validator import GeometryFault

MAX_IDENTIFIER = 100
MAX_NAME = 255


def checked_text(value: Any, place: str, maximum: int) -> str:
    """A string, or a number that stands for one; "" when it is missing."""
    if value is None:
        return ""
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise GeometryFault(place, "a text is expected")
    text = str(value).strip() if not isinstance(value, int) or abs(value) < 10**40 else ""
    if len(text) > maximum:
        raise GeometryFault(place, f"the text has {len(text)} characters; at most {maximum} are taken")
    if "\0" in text or any("\ud800" <= character <= "\udfff" for character in text):
        raise GeometryFault(place, "the text has characters that are none")
    return text
