"""What workers have stored in English, in the language of whoever reads it: they do not know who that will be."""

import re
from functools import cache

from django.utils.translation import gettext as _
from django.utils.translation import gettext_noop

# A stored sentence is found by the one that it was made from; what was put in is put in again.
TEMPLATES = (
    gettext_noop("Looking for a first plan"),
    gettext_noop("Looking up the targets"),
    gettext_noop("Measuring the ways between the targets"),
    gettext_noop("Working out heights and checking every leg"),
    gettext_noop("Working out what the locked parts cost"),
    gettext_noop("Planned"),
    gettext_noop("Stopped; the best plan until then is kept"),
    gettext_noop("Cancelled"),
    gettext_noop("Refused"),
    gettext_noop("Applied"),
    gettext_noop("writing"),
    gettext_noop("comparing"),
    gettext_noop("Comparing"),
    gettext_noop("Fetching"),
    gettext_noop("Waiting to be fetched"),
    gettext_noop("asking Overpass"),
    gettext_noop("%(size)s MiB from Overpass"),
    gettext_noop("Overpass is busy; next try in %(seconds)s s"),
    gettext_noop("writing the heights"),
    gettext_noop("reading the heights"),
    gettext_noop("reading the rows"),
    gettext_noop("reading the rows, row %(row)s"),
    gettext_noop("writing the assets"),
    gettext_noop("reading the zones"),
    gettext_noop("writing the zones"),
    gettext_noop("reading the ground"),
    gettext_noop("relations"),
    gettext_noop("ways"),
    gettext_noop("way nodes"),
    gettext_noop("towers and poles"),
    gettext_noop("geometry"),
    gettext_noop("read"),
    gettext_noop("looking the file over, %(size)s MiB"),
    gettext_noop("The subscription is no longer there."),
    gettext_noop("The ground has changed since: look at the difference again."),
    gettext_noop("Held back: look at the difference."),
    gettext_noop("The columns of the file are not explained yet."),
    gettext_noop("Records of the file that have a fault and are left out: %(number)s."),
    gettext_noop("Values of the file that cannot be read and would be empty: %(number)s."),
    gettext_noop("It removes %(removed)s of %(known)s rows of its source, %(percent)s %%; at most %(limit)s %% may be removed."),
    gettext_noop("Missions that are flown or were sent to UAVs and whose targets or routes it touches: %(number)s."),
    gettext_noop("The mission was changed while its plan was being made. Plan it again."),
    gettext_noop("Only drafts and planned missions can be planned."),
    gettext_noop("A mission needs at least one UAV and one target."),
    gettext_noop("No plan within %(minutes)s min. Split the mission."),
    gettext_noop("The planner failed; the error is in the log."),
    gettext_noop("The worker was lost %(times)s times; the job is given up."),
    gettext_noop("Not done within the time limit; it is not tried again."),
    gettext_noop("Reading the file takes more processor time than a file of its size may need."),
    gettext_noop("The file is empty."),
    gettext_noop("The file cannot be read: %(error)s"),
    gettext_noop("This is neither OSM XML, OSM PBF nor Overpass JSON."),
    gettext_noop("The PBF is cut off or damaged at byte %(byte)s."),
    gettext_noop("The file has no power lines, towers, railways or bridges."),
    gettext_noop("This is neither a GeoTIFF nor an HGT file, zipped or not."),
    gettext_noop("This is no JSON: %(error)s"),
    gettext_noop("The text is not UTF-8: byte %(byte)s cannot be read."),
    gettext_noop("The file could not be read."),
    gettext_noop("polygon is not closed"),
    gettext_noop("the border crosses itself"),
    gettext_noop("Minutes or seconds of 60 were read as the next degree or minute: %(places)s."),
    gettext_noop(
        "%(voids)s of %(posts)s posts are void (%(percent)s %%), %(undeclared)s of them without being declared. "
        "An older model fills them where it reaches; elsewhere the ground stays unknown. Nothing is made up."
    ),
    gettext_noop(
        "%(voids)s of %(posts)s posts are void (%(percent)s %%). "
        "An older model fills them where it reaches; elsewhere the ground stays unknown. Nothing is made up."
    ),
    # of rehearsals in simulation
    gettext_noop("Waiting for a worker"),
    gettext_noop("Flying %(number)s of %(all)s"),
    gettext_noop("Rehearsed"),
    gettext_noop("Planning “%(mission)s”"),
    gettext_noop("Starting the simulated UAVs of “%(mission)s”"),
    gettext_noop("Loading “%(mission)s”"),
    gettext_noop("Starting “%(mission)s”"),
    gettext_noop("Flying “%(mission)s”"),
    gettext_noop("Demo missions made"),
    gettext_noop("The demo region was removed."),
    gettext_noop("The demo missions were not flown in time."),
    gettext_noop("The simulation of the demo mission failed."),
    gettext_noop("%(uav)s did not take a command."),
    gettext_noop("The demo missions could not be made; the error is in the log."),
    gettext_noop("The mission was changed while it was being rehearsed. Rehearse it again."),
    gettext_noop("Zones, terrain, towers or wires about the routes were changed while the mission was being rehearsed. Rehearse it again."),
    gettext_noop("Not flown within %(minutes)s min. Rehearse fewer conditions at once, or split the mission."),
    gettext_noop("The rehearsal failed inside Spanwise; the error is in the log."),
    # what simulated UAVs say of trouble; those that begin alike stand in front of the shorter ones
    gettext_noop("Battery low: %(percent)s %%: return"),
    gettext_noop("Battery low: %(percent)s %%: land"),
    gettext_noop("Battery low: %(percent)s %%"),
    gettext_noop("Battery critical: %(percent)s %%: return"),
    gettext_noop("Battery critical: %(percent)s %%: land"),
    gettext_noop("Battery critical: %(percent)s %%"),
    gettext_noop("Battery empty: the motors stop"),
    gettext_noop("Battery %(percent)s %%"),
    gettext_noop("No GPS fix, dead reckoning"),
    gettext_noop("GPS lost: return"),
    gettext_noop("GPS lost: land"),
    gettext_noop("GPS lost"),
    gettext_noop("Touched the ground outside of a landing"),
    gettext_noop("It overturned."),
    gettext_noop("It hit the ground at %(speed)s m/s."),
    gettext_noop("The flight model: %(error)s."),
    gettext_noop("The battery holds %(percent)s %%."),
    gettext_noop("There is no GPS fix."),
    gettext_noop("There is no mission."),
    gettext_noop("A take-off to %(height)s m is not flown."),
    # of offers of another plan while a mission flies
    gettext_noop("Working out what is left"),
    gettext_noop("Looking up what is left"),
    gettext_noop("Comparing ways to share it out"),
    gettext_noop("Worked out"),
    gettext_noop("It was asked for again."),
    gettext_noop("Something else has happened since."),
    gettext_noop("It was not worked out in time."),
    gettext_noop("The mission does not fly any more."),
    gettext_noop("It was worked out too long ago."),
    gettext_noop("Nothing would change: the UAVs fly on as they do."),
    gettext_noop("No other UAV of the mission is in the air."),
    gettext_noop("Its battery does not last for its route."),
    gettext_noop("%(zone)s lies across its route."),
    gettext_noop("Taken over by %(mission)s."),
    gettext_noop("Continues %(mission)s."),
    gettext_noop("%(uav)s was given another command since."),
    gettext_noop("Its reason has ended: %(uav)s continues its mission."),
    gettext_noop("%(target)s was done meanwhile."),
    gettext_noop("%(uav)s is not where it was reckoned to be."),
    gettext_noop("%(uav)s has passed the diversion point."),
    gettext_noop("%(uav)s: no recent telemetry, position unknown."),
    gettext_noop("%(uav)s has dropped out."),
    gettext_noop("%(uav)s was told to come down."),
    gettext_noop("%(uav)s is flown by a companion computer, which is not given another mission in the air."),
    gettext_noop("%(uav)s has not taken off."),
    gettext_noop("%(uav)s flies its route in several flights, and lands in between."),
    gettext_noop("%(uav)s is %(metres)s m off its route."),
    gettext_noop("%(uav)s would fly below the place where it took off."),
    gettext_noop("The battery of %(uav)s does not last for it."),
    gettext_noop("%(uav)s comes to it too soon, or has too little of its route left. Hold it, and plan the rest again."),
    gettext_noop("%(uav)s has no range left."),
    gettext_noop("%(uav)s has too little battery left."),
    gettext_noop("%(uav)s does as many targets as it may."),
    gettext_noop("A flight of %(uav)s has failed: it does not fly on in this mission."),
)


@cache
def _pattern(template: str) -> re.Pattern[str]:
    parts = re.split(r"%\((\w+)\)s", template)
    return re.compile(
        "".join(f"(?P<{part}>.+)" if index % 2 else re.escape(part.replace("%%", "%")) for index, part in enumerate(parts)), re.S
    )


def render_message(stored: str) -> str:
    """The same sentence in the reader's language; as it is where nobody has foreseen it. Several stand on lines of their own."""
    if "\n" in stored:
        return "\n".join(render_message(line) for line in stored.split("\n"))
    for template in TEMPLATES:
        if match := _pattern(template).fullmatch(stored):
            return _(template) % match.groupdict() if match.groupdict() else _(template)
    return stored
