"""Cells of exported tables that no spreadsheet runs."""

import re

# Spreadsheets read a cell as a formula if it begins so, also after blanks and in full width. A semicolon as separator begins a cell.
_FORMULA = re.compile(r"^(?=[\t\r])|(?:^|(?<=[;\t\r\n]))(?=[\s\u200b\ufeff]*[=+\-@\uff1d\uff0b\uff0d\uff20])")


def without_formula(value: str) -> str:
    """Return the text in a form that no spreadsheet reads as a formula."""
    return _FORMULA.sub("'", value)
