"""HTML shells of the pages, with the signed-in user; all other content comes from the REST API."""

from typing import Any

from django.http import Http404

from inspection.map_pages import map_page
from missions.models import Campaign, MissionState
from missions.selectors.missions import mission_bounds, state_of_mission
from missions.services.missions import EDITABLE
from workspace.pages import ALERT_COUNTS, GROUND, SignedInPage


class MissionsPage(SignedInPage):
    template_name = "missions.html"


class MissionPage(SignedInPage):
    """The operator's map, for a new mission or a stored one of the user's organisation.

    An approved mission is shown read-only, as to users who cannot plan. `stage` is the part of it shown beside the map.
    """

    template_name = "mission.html"
    answers = (ALERT_COUNTS, GROUND)
    stage = "plan"

    def page(self, **kwargs: Any) -> dict[str, Any]:
        mission_id = kwargs.get("mission_id")
        user = self.request.user
        state = state_of_mission(user.organisation_id, mission_id) if mission_id else MissionState.DRAFT
        if state is None:
            raise Http404
        is_frozen = state not in EDITABLE
        return {
            "canPlan": user.can_plan and not is_frozen,
            "canFly": user.can_plan,
            "isFrozen": is_frozen,
            "stage": self.stage,
            "mission": str(mission_id) if mission_id else None,
            "bounds": mission_bounds(mission_id) if mission_id else None,
        } | map_page(user)


class CampaignPage(SignedInPage):
    """Days, crews and missions of a campaign on the map."""

    template_name = "campaign.html"

    def page(self, **kwargs: Any) -> dict[str, Any]:
        user = self.request.user
        campaign_id = kwargs["campaign_id"]
        if not Campaign.objects.filter(organisation=user.organisation, pk=campaign_id).exists():
            raise Http404
        return {"canPlan": user.can_plan, "campaign": str(campaign_id)} | map_page(user)


class FleetPage(SignedInPage):
    """UAVs, their types and bases."""

    template_name = "fleet.html"
    extra_context = {"section": "fleet"}

    def page(self, **kwargs: Any) -> dict[str, Any]:
        return map_page(self.request.user)
