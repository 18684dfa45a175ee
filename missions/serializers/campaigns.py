"""Campaigns in the shapes of the API."""

from collections.abc import Iterator
from typing import Any

from django.utils.translation import gettext as _

from inspection.geodesy import LonLat
from missions.fields import PositionField
from missions.models import Campaign, MissionState, Route
from missions.models.campaigns import MAX_NAME_LENGTH
from missions.serializers.inputs import OptionsSerializer, TargetInputSerializer, UavInputSerializer
from missions.serializers.known_fields import KnownFieldsSerializer
from missions.serializers.limits import MAX_SORTIES
from missions.serializers.shapes import LineSerializer
from planning.campaigns.campaign import BEYOND_REACH
from planning.campaigns.crew_days import Crews
from planning.campaigns.rules import CampaignRules
from workspace.api import strict_serializers as serializers
from workspace.api.fields import FiniteFloatField, WhySerializer
from workspace.jobs.serializers import Declared
from workspace.reason_texts import with_message

MAX_SITES = 200
MAX_CREWS = 20
RULES = CampaignRules(Crews(LonLat(0.0, 0.0)))  # the defaults


class LaunchSiteSerializer(KnownFieldsSerializer):
    name = serializers.CharField(max_length=100, allow_blank=True, required=False, default="")
    position = PositionField()
    is_required = serializers.BooleanField(
        required=False, default=False, help_text="used wherever it is the nearest one; others are used where they are needed"
    )


class CampaignRulesSerializer(KnownFieldsSerializer):
    """Crews, launch sites, and how far UAVs may be from them. Drives are estimated: the straight line times 1.417 at this speed."""

    start = PositionField(help_text="where crews start and end their days")
    crews = serializers.IntegerField(
        min_value=1,
        max_value=MAX_CREWS,
        required=False,
        default=RULES.crews.count,
        help_text="each with such UAVs; those of the request are the first crew's, the missions of the others name no stored UAV",
    )
    drive_kmh = FiniteFloatField(min_value=5, max_value=130, required=False, default=40.0, help_text="by road, in the mean")
    set_up_min = FiniteFloatField(
        min_value=0, max_value=240, required=False, default=15.0, help_text="at each site, to set up and to pack, together"
    )
    day_h = FiniteFloatField(min_value=1, max_value=24, required=False, default=8.0, help_text="from leaving the start to being back")
    reach_m = FiniteFloatField(
        min_value=100, max_value=50_000, required=False, default=RULES.reach_m, help_text="greatest distance of a target from its site"
    )
    flights = serializers.IntegerField(
        min_value=1,
        max_value=MAX_SORTIES,
        required=False,
        default=RULES.flights,
        help_text="of each UAV in a mission, at most, each on a full battery",
    )
    sites = LaunchSiteSerializer(many=True, required=False, default=list, help_text="launch sites to use")
    proposes_sites = serializers.BooleanField(
        required=False,
        default=True,
        help_text="propose further sites 40 m beside ends of targets, outside zones, clear of towers and wires; roads are not checked",
    )

    def validate_sites(self, value: list[dict[str, Any]]) -> list[dict[str, Any]]:
        if len(value) > MAX_SITES:
            raise serializers.ValidationError(_("At most %(most)s launch sites.") % {"most": MAX_SITES})
        return value

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        if not (attrs["sites"] or attrs["proposes_sites"]):
            raise serializers.ValidationError({"sites": _("State launch sites, or let some be proposed.")})
        return attrs


class CampaignInputSerializer(OptionsSerializer):
    """A name, UAVs and targets as in a mission, and the rules. UAVs start and end at the launch sites, at any time, without locks."""

    locks: Declared = None
    departs_at: Declared = None
    return_to_start: Declared = None
    name = serializers.CharField(max_length=MAX_NAME_LENGTH)
    uavs = UavInputSerializer(many=True, allow_empty=False)
    targets = TargetInputSerializer(many=True, allow_empty=False)
    rules = CampaignRulesSerializer()


class CampaignPlanSerializer(KnownFieldsSerializer):
    rules = CampaignRulesSerializer()


class CampaignMissionSerializer(serializers.Serializer):
    number = serializers.IntegerField(help_text="in the order of flying, from 1")
    mission = serializers.UUIDField()
    state = serializers.ChoiceField(choices=MissionState.choices, allow_null=True, help_text="null: the mission has been deleted")
    site = serializers.IntegerField(help_text="its place in `sites`, from 0")
    targets = serializers.IntegerField()
    flights = serializers.IntegerField()
    length_m = serializers.FloatField()
    work_s = serializers.FloatField(help_text="from the first take-off to the last landing")
    farthest_m = serializers.FloatField(help_text="greatest distance of a route from the site; it may lie beyond the reach of targets")
    warnings = serializers.IntegerField(help_text="number of warnings of its plan")
    is_too_long = serializers.BooleanField(help_text="it takes longer than a working day, so it is in none")


class CampaignVisitSerializer(serializers.Serializer):
    """A crew's stay at a site. Times are seconds after it left the start that day."""

    mission = serializers.IntegerField(help_text="number of the mission")
    drive_m = serializers.FloatField(help_text="to the site, estimated")
    drive_s = serializers.FloatField()
    arrives_s = serializers.FloatField()
    leaves_s = serializers.FloatField()


class CampaignDaySerializer(serializers.Serializer):
    day = serializers.IntegerField(help_text="from 1")
    crew = serializers.IntegerField(help_text="from 1")
    visits = CampaignVisitSerializer(many=True)
    back_m = serializers.FloatField(help_text="the drive back to the start")
    back_s = serializers.FloatField()
    ends_s = serializers.FloatField(help_text="when the crew is back")


class CampaignUnassignedSerializer(serializers.Serializer):
    target = serializers.IntegerField(help_text="its place in the campaign's targets")
    reason = serializers.CharField(help_text=f"as in plans, or {BEYOND_REACH}: no launch site is near enough")
    message = serializers.CharField()
    why = WhySerializer(many=True)


class CampaignScheduleSerializer(serializers.Serializer):
    sites = LaunchSiteSerializer(many=True, help_text="proposed ones have no name")
    blocked_sites = LaunchSiteSerializer(many=True, help_text="stated ones that are not used: they lie inside a no-fly zone, or too near")
    missions = CampaignMissionSerializer(many=True)
    days = CampaignDaySerializer(many=True)
    is_proven = serializers.BooleanField(help_text="no schedule of these missions has fewer days, or as many with less driving")
    unassigned = CampaignUnassignedSerializer(many=True, help_text="targets that no mission visits")


class CampaignSummarySerializer(serializers.Serializer):
    id = serializers.UUIDField()
    name = serializers.CharField()
    author = serializers.CharField(allow_null=True)
    job = serializers.UUIDField(allow_null=True, help_text="the last job that planned it")
    target_count = serializers.IntegerField()
    mission_count = serializers.IntegerField()
    day_count = serializers.IntegerField()
    planned_at = serializers.DateTimeField(allow_null=True, help_text="null: not planned yet")
    updated_at = serializers.DateTimeField()


class CampaignSerializer(CampaignSummarySerializer):
    rules = CampaignRulesSerializer()
    schedule = CampaignScheduleSerializer(allow_null=True, help_text="null: not planned yet")


class CampaignRoutePropertiesSerializer(serializers.Serializer):
    number = serializers.IntegerField(help_text="of its mission")
    day = serializers.IntegerField(allow_null=True, help_text="null: the mission is in no day")
    uav = serializers.CharField()


class CampaignRouteSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["Feature"])
    geometry = LineSerializer()
    properties = CampaignRoutePropertiesSerializer()


class CampaignRoutesSerializer(serializers.Serializer):
    """Routes of all missions as GeoJSON."""

    type = serializers.ChoiceField(choices=["FeatureCollection"])
    features = CampaignRouteSerializer(many=True)


class CampaignPageSerializer(serializers.Serializer):
    results = CampaignSummarySerializer(many=True)
    next = serializers.CharField(allow_null=True)


def campaign_summary(campaign: Campaign) -> dict[str, Any]:
    return {
        "id": str(campaign.pk),
        "name": campaign.name,
        "author": campaign.author.username if campaign.author else None,
        "job": campaign.job and str(campaign.job),
        "target_count": campaign.target_count,
        "mission_count": campaign.mission_count,
        "day_count": campaign.day_count,
        "planned_at": campaign.planned_at,
        "updated_at": campaign.updated_at,
    }


def campaign_json(campaign: Campaign) -> dict[str, Any]:
    schedule = None if campaign.schedule is None else _schedule(campaign, campaign.schedule)
    return campaign_summary(campaign) | {"rules": campaign.rules, "schedule": schedule}


def _schedule(campaign: Campaign, schedule: dict[str, Any]) -> dict[str, Any]:
    """Return the stored schedule with the present states of its missions, and reasons in the reader's language."""
    states = {str(key): state for key, state in campaign.missions.filter(deleted_at=None).values_list("pk", "state")}
    return schedule | {
        "missions": [mission | {"state": states.get(mission["mission"])} for mission in schedule["missions"]],
        "unassigned": [with_message(item) for item in schedule["unassigned"]],
    }


def campaign_routes_json(campaign: Campaign) -> dict[str, Any]:
    schedule = campaign.schedule or {"missions": [], "days": []}
    number_of = {row["mission"]: row["number"] for row in schedule["missions"]}
    day_of = {visit["mission"]: day["day"] for day in schedule["days"] for visit in day["visits"]}
    rows = Route.objects.filter(mission__campaign=campaign, mission__deleted_at=None, geometry__isnull=False).select_related("mission_uav")
    numbered = sorted((number_of[str(row.mission_id)], row.mission_uav.sequence, row) for row in rows if str(row.mission_id) in number_of)
    return {
        "type": "FeatureCollection",
        "features": [
            {
                "type": "Feature",
                "geometry": {
                    "type": "LineString",
                    "coordinates": [list(point[:2]) for point in row.geometry.coords] if row.geometry else [],
                },
                "properties": {"number": number, "day": day_of.get(number), "uav": row.mission_uav.name},
            }
            for number, _sequence, row in numbered
        ],
    }


DAY_COLUMNS = (
    "day", "crew", "mission", "name", "state", "site", "longitude", "latitude", "drive_km", "drive_min", "arrives_min", "leaves_min",
    "targets", "flights", "flown_km", "work_min", "farthest_m",
)  # fmt: skip


def day_rows(campaign: Campaign) -> Iterator[list[Any]]:
    """Yield a row for each stay at a site and each drive back, as DAY_COLUMNS; times are minutes after the crew left the start that day."""
    schedule = campaign.schedule or {"sites": [], "missions": [], "days": []}
    rows = {row["number"]: row for row in schedule["missions"]}
    known = {str(key): (name, state) for key, name, state in campaign.missions.filter(deleted_at=None).values_list("pk", "name", "state")}
    for day in schedule["days"]:
        for visit in day["visits"]:
            mission = rows[visit["mission"]]
            site = schedule["sites"][mission["site"]]
            yield [
                day["day"], day["crew"], mission["number"], *known.get(mission["mission"], ("", "")),
                site["name"] or _("Launch site %(number)s") % {"number": mission["site"] + 1}, *site["position"],
                *_driven(visit["drive_m"], visit["drive_s"]), _minutes(visit["arrives_s"]), _minutes(visit["leaves_s"]),
                mission["targets"], mission["flights"], round(mission["length_m"] / 1_000.0, 2), _minutes(mission["work_s"]),
                mission["farthest_m"],
            ]  # fmt: skip
        back = [*_driven(day["back_m"], day["back_s"]), _minutes(day["ends_s"])]
        yield [day["day"], day["crew"], None, "", "", _("Start"), *campaign.rules["start"], *back, *[None] * 6]


def _driven(metres: float, seconds: float) -> list[float]:
    return [round(metres / 1_000.0, 1), _minutes(seconds)]


def _minutes(seconds: float) -> float:
    return round(seconds / 60.0, 1)
