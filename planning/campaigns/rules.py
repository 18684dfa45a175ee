"""What is asked of a campaign: its crews, its launch sites, and how far UAVs may be from them."""

from dataclasses import dataclass
from typing import Any

from inspection.geodesy import LonLat
from planning.campaigns.crew_days import Crews


@dataclass(frozen=True)
class LaunchSite:
    """A place where crews can launch; proposed ones have no name. is_required: used wherever it is the nearest one, needed or not."""

    name: str
    position: LonLat
    is_required: bool = False


@dataclass(frozen=True)
class CampaignRules:
    """sites: launch sites to use. proposes_sites: whether others are added at ends of targets where those do not suffice.

    reach_m: greatest distance of a target from its site [m]. flights: of each UAV in one mission, each on a full battery.
    """

    crews: Crews
    reach_m: float = 3_000.0
    flights: int = 4
    sites: tuple[LaunchSite, ...] = ()
    proposes_sites: bool = True


def rules_to_json(rules: CampaignRules) -> dict[str, Any]:
    crews = rules.crews
    return {
        "start": list(crews.start),
        "crews": crews.count,
        "drive_kmh": round(crews.drive_mps * 3.6, 6),
        "set_up_min": crews.set_up_s / 60.0,
        "day_h": crews.day_s / 3600.0,
        "reach_m": rules.reach_m,
        "flights": rules.flights,
        "sites": [{"name": site.name, "position": list(site.position), "is_required": site.is_required} for site in rules.sites],
        "proposes_sites": rules.proposes_sites,
    }


def rules_from_json(value: dict[str, Any]) -> CampaignRules:
    crews = Crews(
        start=LonLat(*value["start"]),
        count=value["crews"],
        drive_mps=value["drive_kmh"] / 3.6,
        set_up_s=value["set_up_min"] * 60.0,
        day_s=value["day_h"] * 3600.0,
    )
    sites = tuple(LaunchSite(site["name"], LonLat(*site["position"]), site["is_required"]) for site in value["sites"])
    return CampaignRules(crews, value["reach_m"], value["flights"], sites, value["proposes_sites"])
