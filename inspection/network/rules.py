"""How far apart things may stand and still be linked."""

from dataclasses import dataclass


@dataclass(frozen=True)
class LinkingRules:
    """Radii and spacing in metres. The two bridge radii are the reference article's."""

    bridge_to_tower_m: float = 3_000.0
    bridge_to_bridge_m: float = 5_000.0
    railway_to_tower_m: float = 3_000.0  # only where a railway would else be cut off
    crossing_m: float = 150.0  # supports of different lines, and bridges and supports beside railways: crossings, substations
    railway_spacing_m: float = 250.0  # a railway's way vertices are thinned to at most this
    off_network_factor: float = 2.0  # cost per metre away from infrastructure, so that routes stay near the lines
    detour_m: float = 10_000.0  # the longest way round zones, between the ends of what they cut out of a line; 0 for none
    zone_clearance_m: float = 12.0  # error of a satellite position, twice, and 2 m of tracking: a rehearsal asks for 10 m
