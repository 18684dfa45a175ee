"""Faults as they are told from outside: JSON with those that last from now on, and what they make of the faults before."""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from simulation.flight.faults import Faults, ImpossibleFault

FAULTS = frozenset({"link_lost_for_s", "gps_lost_for_s", "battery_wh_left", "motor_failed", "stuck_item", "clock_offset_s"})
WHOLE = frozenset({"motor_failed", "stuck_item"})
LASTING = ("link_lost", "gps_lost")

Changed = Callable[[Faults, float], Faults]


class WrongFaults(ValueError):
    """Faults that no UAV can be given."""


def faults_told(told: Any) -> Changed:
    """From the faults before and simulated seconds to those from now on; what is not told stays as it is. Raises WrongFaults."""
    if not isinstance(told, Mapping) or not told.keys() <= FAULTS:
        raise WrongFaults(f"only {', '.join(sorted(FAULTS))} can be told")
    values: dict[str, Any] = {name: _value(name, value) for name, value in told.items()}
    lasting = {f"{name}_until_s": values.pop(f"{name}_for_s") or 0.0 for name in LASTING if f"{name}_for_s" in values}

    def changed(before: Faults, now_s: float) -> Faults:
        until: dict[str, Any] = {name: now_s + for_s for name, for_s in lasting.items()}
        return replace(before, **values, **until)

    try:
        changed(Faults(), 0.0)
    except (ImpossibleFault, TypeError) as error:
        raise WrongFaults(str(error)) from error
    return changed


def _value(name: str, value: Any) -> Any:
    if value is None:
        return 0.0 if name == "clock_offset_s" else None
    if isinstance(value, bool) or (name in WHOLE and not isinstance(value, int)):
        raise WrongFaults(f"{name} is a whole number or null")
    if not isinstance(value, int | float) or not math.isfinite(value):
        raise WrongFaults(f"{name} is a number")
    return value if name in WHOLE else float(value)
