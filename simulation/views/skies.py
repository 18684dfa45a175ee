"""Conditions as requests name them."""

from collections.abc import Sequence
from typing import Any

from inspection.views.parameters import invalid
from planning.energy.conditions import Conditions, InvalidConditions
from simulation.rehearsing.weather_scenario import Named, Sky, named_sky, own_sky


def skies_of(asked: Sequence[Any], planned: Conditions) -> list[Sky]:
    """Names and own figures, given the conditions that were planned with. Raises ApiProblem."""
    return [sky_of(entry, planned, f"conditions.{number}") for number, entry in enumerate(asked)]


def sky_of(entry: Any, planned: Conditions, place: str = "conditions") -> Sky:
    """Raises ApiProblem, with `place` as where the fault stands."""
    try:
        return named_sky(Named(entry), planned) if isinstance(entry, str) else own_sky(entry, planned)
    except InvalidConditions as error:
        raise invalid(f"{place}.{error.place}", f"{error.place} {error.message}.") from error
    except ValueError as error:
        names = ", ".join(str(code) for code in Named if code is not Named.OWN)
        raise invalid(place, f"{entry!r} is none of {names}.") from error
