"""The list of categories of findings: what is wrong with which component.

Words in brackets name the source: CNAIM v2.1 (Ofgem), GO 95 (CPUC), FAC-003-4 (NERC), InsPLAD and dacl10k (classes of data sets). A finding
keeps the scheme that it was made with.
"""

from dataclasses import dataclass

from operation.reasons import gettext_noop

SCHEME = "spanwise-1"
OTHER = "other"


@dataclass(frozen=True)
class Category:
    """One category. needs_note: it says nothing without one."""

    code: str
    component: str
    name: str
    needs_note: bool = False


COMPONENTS = {
    "tower": gettext_noop("Tower"),  # CNAIM: legs, bracings, crossarms, peak
    "foundation": gettext_noop("Paint and foundation"),
    "pole": gettext_noop("Pole"),
    "insulator": gettext_noop("Insulator"),
    "fitting": gettext_noop("Fitting"),
    "conductor": gettext_noop("Conductor"),
    "vegetation": gettext_noop("Vegetation and right of way"),
    "bridge": gettext_noop("Bridge"),
    "track": gettext_noop("Track"),
    "any": gettext_noop("Any component"),
}
CATEGORIES = (
    Category("tower-corrosion", "tower", gettext_noop("Corrosion")),
    Category("tower-member-bent", "tower", gettext_noop("Member bent or cracked")),
    Category("tower-member-missing", "tower", gettext_noop("Member missing")),
    Category("tower-bolt", "tower", gettext_noop("Bolt loose or missing")),
    Category("tower-leaning", "tower", gettext_noop("Leaning")),
    Category("tower-nest", "tower", gettext_noop("Nest")),  # InsPLAD
    Category("tower-plate", "tower", gettext_noop("Plate missing or unreadable")),
    Category("foundation-paint", "foundation", gettext_noop("Paint breakdown")),
    Category("foundation-cracked", "foundation", gettext_noop("Foundation cracked or exposed")),
    Category("foundation-settlement", "foundation", gettext_noop("Settlement")),
    Category("foundation-erosion", "foundation", gettext_noop("Erosion or standing water")),
    Category("pole-condition", "pole", gettext_noop("Visible deterioration")),
    Category("pole-leaning", "pole", gettext_noop("Pole leaning")),
    Category("pole-animal", "pole", gettext_noop("Bird or animal damage")),
    Category("pole-rot", "pole", gettext_noop("Rot at the top")),
    Category("insulator-broken", "insulator", gettext_noop("Disc broken or missing")),
    Category("insulator-flashover", "insulator", gettext_noop("Flashover marks or pollution")),
    Category("insulator-chipped", "insulator", gettext_noop("Shed chipped")),
    Category("insulator-tracking", "insulator", gettext_noop("Tracking")),
    Category("insulator-corroded", "insulator", gettext_noop("Cap or pin corroded")),
    Category("insulator-displaced", "insulator", gettext_noop("String displaced")),
    Category("insulator-ring", "insulator", gettext_noop("Grading ring missing")),
    Category("fitting-corrosion", "fitting", gettext_noop("Fitting corroded")),
    Category("fitting-pin", "fitting", gettext_noop("Pin, nut or bolt missing")),
    Category("fitting-damper", "fitting", gettext_noop("Damper slipped or missing")),
    Category("fitting-spacer", "fitting", gettext_noop("Conductor out of spacer or clamp")),
    Category("fitting-hot", "fitting", gettext_noop("Hot joint")),
    Category("conductor-strands", "conductor", gettext_noop("Broken strands")),
    Category("conductor-bulging", "conductor", gettext_noop("Bulging")),
    Category("conductor-corrosion", "conductor", gettext_noop("Conductor corroded")),
    Category("conductor-object", "conductor", gettext_noop("Foreign object")),
    Category("conductor-sag", "conductor", gettext_noop("Sag or clearance doubtful")),
    Category("vegetation-inside", "vegetation", gettext_noop("Inside the clearance")),  # FAC-003
    Category("vegetation-fall-in", "vegetation", gettext_noop("May fall into the line")),
    Category("vegetation-growth", "vegetation", gettext_noop("Growth expected")),
    Category("vegetation-building", "vegetation", gettext_noop("Building or crane below")),
    Category("vegetation-fire", "vegetation", gettext_noop("Fire load")),
    Category("bridge-crack", "bridge", gettext_noop("Crack")),  # dacl10k
    Category("bridge-alligator", "bridge", gettext_noop("Alligator crack")),
    Category("bridge-spalling", "bridge", gettext_noop("Spalling")),
    Category("bridge-rebar", "bridge", gettext_noop("Exposed rebar")),
    Category("bridge-rust", "bridge", gettext_noop("Rust")),
    Category("bridge-efflorescence", "bridge", gettext_noop("Efflorescence")),
    Category("bridge-wet", "bridge", gettext_noop("Wet spot")),
    Category("bridge-cavity", "bridge", gettext_noop("Cavity or rock pocket")),
    Category("bridge-bearing", "bridge", gettext_noop("Bearing or joint damaged")),
    Category("bridge-drainage", "bridge", gettext_noop("Drainage damaged")),
    Category("track-code", "track", gettext_noop("Defect by code"), needs_note=True),  # EN 17397: the code is in the note
    Category("no-access", "any", gettext_noop("No access")),
    Category("not-assessable", "any", gettext_noop("Not assessable")),
    Category(OTHER, "any", gettext_noop("Something else"), needs_note=True),
)
BY_CODE = {category.code: category for category in CATEGORIES}
