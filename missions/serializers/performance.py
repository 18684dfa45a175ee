"""Faults of a UAV's values, in the reader's language."""

import math

from django.utils.translation import gettext as _

from planning.energy.performance import InvalidPerformance


def fault_words(error: InvalidPerformance) -> str:
    if error.bounds is None:
        return error.message
    low, high = error.bounds
    if error.place == "hover_power_w":
        return _("From %(low)s to %(high)s W for this mass and these rotors.") % {"low": math.ceil(low), "high": math.floor(high)}
    return _("From %(low)s to %(high)s.") % {"low": f"{low:g}", "high": f"{high:g}"}
