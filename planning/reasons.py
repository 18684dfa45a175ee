"""Reasons as a code and what fills its sentence. Sentences are English; whoever shows one translates it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any


def ngettext_noop(singular: str, plural: str) -> tuple[str, str]:
    """Mark a sentence that has a plural for translation."""
    return singular, plural


def gettext_noop(sentence: str) -> str:
    """Mark a sentence for translation."""
    return sentence


# By code. A pair is the singular and the plural, chosen by the parameter `count`.
SENTENCES: dict[str, str | tuple[str, str]] = {
    "no_battery_to_save": gettext_noop("Without a battery %(uav)s has no energy to save."),
    "sorties_without_return": gettext_noop("%(uav)s can fly again only where it returns to its start."),
    "unknown_uav_name": gettext_noop("There is no UAV named %(name)s in this plan."),
    "ambiguous_uav_name": gettext_noop("%(count)s UAVs of this plan are named %(name)s."),
    "unknown_target": gettext_noop("There is no target %(target)s."),
    "target_locked_twice": gettext_noop("Target %(target)s is locked twice."),
    "target_tied_elsewhere": gettext_noop("Target %(target)s is tied to %(uav)s, another UAV than it is locked to."),
    "sensor_missing": gettext_noop("Target %(target)s needs the sensor %(sensor)s, which %(uav)s does not have."),
    "two_runs_at_start": gettext_noop("%(uav)s has another locked run at its start."),
    "two_runs_at_end": gettext_noop("%(uav)s has another locked run at its end."),
    "run_is_whole_route": gettext_noop("A locked run is all that %(uav)s flies: it has no place for another one."),
    "too_many_locked": ngettext_noop(
        "%(uav)s may do %(most)s target at most, but %(locked)s are locked to it.",
        "%(uav)s may do %(most)s targets at most, but %(locked)s are locked to it.",
    ),
    "wind_too_strong_on_route": gettext_noop("The wind is too strong for %(uav)s on its route."),
    "target_deleted": gettext_noop("A target of this route is no longer in the data. Plan again."),
    "target_unreachable": gettext_noop("A target of this route cannot be reached any more. Plan again."),
    "uav_inside_zone": gettext_noop("This UAV stands inside a no-fly zone now. Plan again."),
    "uav_flies_no_route": gettext_noop("This UAV flies no route."),
}


@dataclass(frozen=True)
class Reason:
    """code is a key of SENTENCES; params fill its sentence."""

    code: str
    params: Mapping[str, Any] = field(default_factory=dict)

    def __str__(self) -> str:
        return self.text(lambda sentence: sentence, lambda singular, plural, count: singular if count == 1 else plural)

    def text(self, gettext: Callable[[str], str], ngettext: Callable[[str, str, int], str]) -> str:
        """The sentence in the language of these functions, which work as gettext's do."""
        sentence = SENTENCES[self.code]
        words = gettext(sentence) if isinstance(sentence, str) else ngettext(*sentence, self.params["count"])
        return words % self.params if self.params else words
