"""Figures in sentences, written as the reader writes them."""

from django.utils.formats import number_format


def number_text(value: float, decimals: int = 0) -> str:
    """ "1,234.5", in German "1.234,5"."""
    return str(number_format(round(value, decimals), decimal_pos=decimals, use_l10n=True, force_grouping=True))
