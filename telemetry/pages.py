"""Pages of flights: HTML shells, filled by the websocket and the REST API."""

from typing import Any
from uuid import UUID

from django.http import Http404

from inspection.map_pages import map_page
from missions.models import Mission, MissionUav
from missions.selectors.missions import mission_bounds, missions_in_the_air
from workspace.pages import GROUND, SignedInPage

MAX_EARLY_MISSIONS = 4  # which the browser requests beside the page's script


class LivePage(SignedInPage):
    """The live page of the organisation's fleet."""

    template_name = "live.html"
    answers = (GROUND,)
    extra_context = {"section": "live"}

    def get_context_data(self, **kwargs: Any) -> dict[str, Any]:
        shown = missions_in_the_air(self.request.user.organisation_id, limit=MAX_EARLY_MISSIONS)
        return super().get_context_data(**kwargs) | {"shown_missions": shown}

    def page(self, **kwargs: Any) -> dict[str, Any]:
        return {"canFly": self.request.user.can_plan, "mission": None, "bounds": None} | map_page(self.request.user)


class MissionStagePage(SignedInPage):
    """A page of one mission of the user's organisation."""

    def page(self, **kwargs: Any) -> dict[str, Any]:
        mission_id: UUID = kwargs["mission_id"]
        user = self.request.user
        own = Mission.objects.filter(organisation=user.organisation_id, deleted_at=None, pk=mission_id)
        mission = own.select_related("simulates").first()
        if mission is None:
            raise Http404
        original = mission.simulates
        simulated = MissionUav.objects.filter(mission=mission_id).values_list("uav__is_simulated", flat=True)
        return {
            "hasSimulated": any(simulated),
            "hasReal": not all(simulated),
            "isSimulated": bool(simulated) and all(simulated),
            "canFly": user.can_plan,
            "mission": str(mission_id),
            "missionName": mission.name,
            "simulates": None if original is None else {"id": str(original.pk), "name": original.name},
            "bounds": mission_bounds(mission_id),
        } | map_page(user)


class MissionFlyPage(MissionStagePage):
    template_name = "live.html"
    answers = (GROUND,)

    def get_context_data(self, **kwargs: Any) -> dict[str, Any]:
        return super().get_context_data(**kwargs) | {"shown_missions": [kwargs["mission_id"]]}


class MissionReportPage(MissionStagePage):
    template_name = "report.html"


class MissionScenePage(MissionStagePage):
    """The 3D view of a flight: planned, rehearsed, live or recorded, by the URL."""

    template_name = "scene.html"
