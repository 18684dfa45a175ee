"""Figures in sentences, as the reader writes them."""

import pytest
from django.utils.translation import override

from workspace.locale_negotiation import number_text


@pytest.mark.parametrize(
    ("language", "value", "decimals", "text"),
    [
        ("en", 1_234.56, 1, "1,234.6"),
        ("de", 1_234.56, 1, "1.234,6"),
        ("de", 0.04, 1, "0,0"),
        ("en", 999.6, 0, "1,000"),
        ("de", 12.0, 0, "12"),
    ],
)
def test_a_figure_is_written_as_its_reader_does(language: str, value: float, decimals: int, text: str) -> None:
    with override(language):
        assert number_text(value, decimals) == text
