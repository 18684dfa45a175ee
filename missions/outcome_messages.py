"""What became of commands, as gateways and companions have stored it in English, in the language of whoever reads it.

Unlike other stored words an outcome may be several sentences, and what a vehicle itself said is among them: that stays as it is.
"""

import re
from functools import cache

from django.utils.translation import gettext as _
from django.utils.translation import gettext_noop

# A sentence is found by the one that it was made from; what was put in is put in again, and read likewise where it is one of PARTS.
SENTENCES = (
    gettext_noop("The gateway failed; the error is in its log."),
    gettext_noop("The vehicle did not do it."),
    gettext_noop("The vehicle is in another state by now."),
    gettext_noop("The vehicle did not answer."),
    gettext_noop("The vehicle agreed, and nothing happened."),
    gettext_noop("The vehicle did it, and left it again."),
    gettext_noop("Could not %(order)s, at %(step)s."),
    gettext_noop("Only PX4 and ArduPilot are commanded: what another autopilot does is not known."),
    gettext_noop("The UAV does not tell whether it stands or flies."),
    gettext_noop("The UAV is on the ground: a mission is started there, not resumed."),
    gettext_noop("The UAV is on the ground: this route begins in the air."),
    gettext_noop("This route begins in the air, and the UAV does not fly."),
    gettext_noop("The UAV is on the ground."),
    gettext_noop("The UAV does not surely hold its approved route: it cannot return along it."),
    gettext_noop("The UAV would fly its route from the beginning: %(parameter)s is not 0."),
    gettext_noop("From where the UAV is now no way along its route is clear."),
    gettext_noop("The UAV is not on the way on which its route begins. Plan the rest again."),
    gettext_noop("The UAV would fly back to where its route begins: set %(parameter)s to 0."),
    gettext_noop("The UAV has not told its height above sea level."),
    gettext_noop("%(name)s must be above 0."),
    gettext_noop("The UAV is %(metres)s m from the leg that it would fly on; %(allowed)s m are allowed."),
    gettext_noop("The UAV is %(metres)s m above the leg that it would fly on; %(allowed)s m are allowed."),
    gettext_noop("The UAV is %(metres)s m below the leg that it would fly on; %(allowed)s m are allowed."),
    gettext_noop("The UAV stands %(metres)s m from the planned take-off; %(allowed)s m are allowed."),
    gettext_noop("The UAV's home is %(metres)s m from the planned take-off; %(allowed)s m are allowed."),
    gettext_noop("The UAV reports %(metres)s m above the planned take-off; %(allowed)s m are allowed."),
    gettext_noop("The UAV reports %(metres)s m below the planned take-off; %(allowed)s m are allowed."),
    gettext_noop("The UAV's home is %(metres)s m above the planned take-off; %(allowed)s m are allowed."),
    gettext_noop("The UAV's home is %(metres)s m below the planned take-off; %(allowed)s m are allowed."),
    gettext_noop("It was approved for a UAV with a companion computer."),
    gettext_noop("Revoke, and approve it again."),
    gettext_noop("The UAV does not hold this flight of the approved mission: send it first."),
    gettext_noop("The UAV does not hold a flight of the approved mission."),
    gettext_noop("Only a mission that was approved can be flown."),
    gettext_noop("Only a mission that is being flown can be resumed."),
    gettext_noop("The approval was taken back."),
    gettext_noop("The approval is not the one that was given: its hash is another one."),
    gettext_noop("The approval has no such flight of this UAV."),
    gettext_noop("The UAV does not tell where its home is, from which it counts its heights."),
    gettext_noop("The UAV does not tell where it stands."),
    gettext_noop("The UAV does not tell where it flies."),
    gettext_noop("The UAV does not tell which waypoint it would fly to."),
    gettext_noop("The UAV does not tell %(parameter)s: whether it would go on or begin anew."),
    gettext_noop("The UAV has flown its mission to the end: there is nothing to go on with."),
    gettext_noop("Nothing was sent: the %(list)s on the vehicle could not be read."),
    gettext_noop("Nothing was sent: the %(list)s on the vehicle is not the approved one (%(difference)s)."),
    gettext_noop("Nothing was sent: what the vehicle holds could not be read."),
    gettext_noop("Nothing was sent."),
    gettext_noop("The UAV has not told how far apart waypoints may be."),
    gettext_noop("Bring the UAV to where its flight begins, or raise %(parameter)s on it."),
    gettext_noop("Revoke, and approve it again with points put in on longer legs."),
    gettext_noop("So are %(count)s more legs."),
    gettext_noop("So is one more leg."),
    gettext_noop("The UAV would not fly it."),
    gettext_noop("The %(list)s has %(count)s items; %(autopilot)s takes %(most)s."),
    gettext_noop("The %(list)s has %(count)s items; %(autopilot)s on most boards takes %(most)s."),
    gettext_noop("The first waypoint is %(metres)s m away; %(parameter)s allows %(allowed)s m."),
    gettext_noop("The leg to item %(item)s is %(metres)s m; %(parameter)s allows %(allowed)s m."),
    gettext_noop("Its %(list)s is a mix: %(mix)s."),
    gettext_noop("Its %(list)s could not be put back: it holds none."),
    gettext_noop("Its %(list)s could not be read."),
    gettext_noop("The vehicle fell silent while its %(list)s was sent: it may hold %(what)s."),
    gettext_noop("Read it back before any flight."),
    gettext_noop("The mission could not be sent whole, and what was there of it was taken off: the vehicle holds none."),
    gettext_noop("The vehicle holds what it held before."),
    gettext_noop("The vehicle has not said what it is."),
    gettext_noop("The vehicle has not told how high it returns."),
    gettext_noop("The vehicle does not answer about %(parameter)s."),
    gettext_noop("%(parameter)s stays %(value)s."),
    gettext_noop("%(parameter)s is %(value)s, read back."),
    gettext_noop("The vehicle is a %(kind)s: Spanwise plans for and commands multicopters only."),
    gettext_noop("Not known to %(autopilot)s: item %(item)s, %(command)s."),
    gettext_noop("Refused by %(autopilot)s: item %(item)s of the %(list)s, %(command)s (%(code)s)."),
    gettext_noop("Of the %(list)s, item %(item)s: %(field)s was sent as %(wanted)s and came back as %(held)s."),
    gettext_noop("There are %(count)s more differences."),
    gettext_noop("The fence on the UAV does nothing: %(parameter)s."),
    gettext_noop("It was not sent in time."),
    gettext_noop("Of its own %(list)s %(count)s items were left as they are."),
    gettext_noop("Missions are sent to PX4 and ArduPilot only: how this autopilot keeps them is not known."),
    gettext_noop("The vehicle is armed and in mode %(mode)s: it must be disarmed or held first."),
    gettext_noop("The UAV holds something else than what was approved."),
    gettext_noop("The UAV does not say what it holds."),
    gettext_noop("The UAV gave no reason."),
)
PARTS = (
    gettext_noop("mission"),
    gettext_noop("fence"),
    gettext_noop("rally"),
    gettext_noop("rally points"),
    gettext_noop("plane"),
    gettext_noop("VTOL"),
    gettext_noop("rover"),
    gettext_noop("boat"),
    gettext_noop("submarine"),
    gettext_noop("vehicle of another kind"),
    gettext_noop("part of the new one and part of the old"),
    gettext_noop("the old one or the new one, whole"),
    gettext_noop("arm"),
    gettext_noop("take-off"),
    gettext_noop("start"),
    gettext_noop("pause"),
    gettext_noop("resume"),
    gettext_noop("hold"),
    gettext_noop("return"),
    gettext_noop("land"),
    gettext_noop("abort"),
    gettext_noop("change-speed"),
    gettext_noop("set-return-height"),
    gettext_noop("disarm"),
    gettext_noop("leave the ground"),
    gettext_noop("start the mission"),
    gettext_noop("begin with the first item"),
    gettext_noop("take off"),
    gettext_noop("change speed"),
)


def _pattern(sentence: str) -> re.Pattern[str]:
    parts = re.split(r"%\((\w+)\)s", sentence)
    words = "".join(f"(?P<{part}>.+?)" if index % 2 else re.escape(part) for index, part in enumerate(parts))
    return re.compile(rf"{words}(?=\s|$)", re.S)


@cache
def _patterns() -> list[tuple[str, re.Pattern[str]]]:
    """Those with more words of their own first: what they leave open is shorter."""
    return [(sentence, _pattern(sentence)) for sentence in sorted(SENTENCES, key=lambda one: -len(re.sub(r"%\(\w+\)s", "", one)))]


_AS_IT_IS = re.compile(r".+?(?:[.;](?=\s)|$)", re.S)


def render_outcome(stored: str) -> str:
    """The same in the reader's language; sentences that nobody has foreseen are as they are."""
    found, rest = [], stored
    while rest := rest.lstrip():
        sentence, stated = _first(rest)
        found.append(stated)
        rest = rest[len(sentence) :]
    return " ".join(found)


# What the outbox itself ends commands with; a link says in its own words why a command failed.
_BY_OUTBOX = {
    "superseded": gettext_noop("A later command took its place."),
    "not-delivered": gettext_noop("It could not be delivered in time."),
    "unconfirmed": gettext_noop("It was sent; whether it was done is not known."),
    "unheard": gettext_noop("Sent again and again; nothing is heard from the UAV, and whether it does it is not known."),
    "withdrawn": gettext_noop("It was withdrawn before it was sent."),
    "revoked": gettext_noop("The approval was revoked."),
    "simulation-ended": gettext_noop("The simulation has ended."),
}


def render_command_outcome(code: str, stored: str) -> str:
    """What became of a command, by its code where the outbox itself ended it."""
    return _(_BY_OUTBOX[code]) if code in _BY_OUTBOX else render_outcome(stored)


def is_foreseen(stored: str) -> bool:
    """Whether all of it is made of known sentences."""
    rest = stored.lstrip()
    while rest:
        match = next((match for _sentence, pattern in _patterns() if (match := pattern.match(rest))), None)
        if match is None:
            return False
        rest = rest[match.end() :].lstrip()
    return True


def _first(rest: str) -> tuple[str, str]:
    """What stands there, and what it is in the reader's language."""
    for sentence, pattern in _patterns():
        if match := pattern.match(rest):
            values = {name: _(value) if value in PARTS else value for name, value in match.groupdict().items()}
            return match[0], _(sentence) % values if values else _(sentence)
    plain = _AS_IT_IS.match(rest)
    assert plain is not None  # noqa: S101 - there is something
    return plain[0], plain[0]
