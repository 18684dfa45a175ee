"""The planner's reasons in the language of whoever reads them."""

from django.utils.translation import gettext, ngettext

from planning.reasons import Reason
from planning.request import InvalidRequest


def reason_text(reason: Reason | str) -> str:
    return reason if isinstance(reason, str) else reason.text(gettext, ngettext)


def fault_texts(error: InvalidRequest) -> dict[str, str]:
    """What is wrong with a request, by place."""
    return {place: reason_text(fault) for place, fault in error.faults.items()}
