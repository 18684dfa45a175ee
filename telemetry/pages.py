"""The pages of what flies: HTML shells; everything on them comes by the live feed and the REST API."""

from typing import Any

from django.http import Http404

from inspection.selectors import ground_extent
from missions.selectors import mission_bounds, state_of_mission
from workspace.pages import SignedInPage, raster_maps


class LivePage(SignedInPage):
    """Every UAV of the user's organisation."""

    template_name = "live.html"
    extra_context = {"section": "live"}

    def page(self, **kwargs: Any) -> dict[str, Any]:
        return {"canFly": self.request.user.can_plan, "mission": None, "extent": ground_extent(), "bounds": None} | raster_maps()


class FlyPage(LivePage):
    """One mission, from its approval to its end."""

    def page(self, **kwargs: Any) -> dict[str, Any]:
        mission_id = kwargs["mission_id"]
        if state_of_mission(self.request.user.organisation_id, mission_id) is None:
            raise Http404
        return super().page() | {"mission": str(mission_id), "bounds": mission_bounds(mission_id)}
