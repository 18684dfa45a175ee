"""The pages: HTML shells that say who is there; everything on them comes from the REST API."""

from typing import Any

from django.contrib.auth.forms import AuthenticationForm
from django.contrib.auth.views import LoginView
from django.core.exceptions import ValidationError
from django.http import Http404

from inspection.selectors import ground_extent
from missions.models import Mission
from missions.selectors import mission_bounds
from workspace.pages import SignedInPage, raster_maps
from workspace.sign_in_attempts import address_of, count_failure, forget_failures, is_locked


class SignInForm(AuthenticationForm):
    """Django's form, with a limit on wrong tries and one message that does not tell which half was wrong."""

    def clean(self) -> dict[str, Any]:
        name = self.cleaned_data.get("username", "")
        address = address_of(self.request)
        if is_locked(name, address):
            raise ValidationError("Too many wrong tries. Wait 15 min, then try again.", code="locked")
        try:
            cleaned = super().clean()
        except ValidationError as error:
            left = count_failure(name, address)
            raise ValidationError(_wrong(left), code="invalid_login") from error
        forget_failures(name, address)
        return cleaned


def _wrong(tries_left: int | None) -> str:
    if tries_left is None:
        return "User name or password is wrong."
    if tries_left == 0:
        return "User name or password is wrong. No tries left for 15 min."
    return f"User name or password is wrong. {tries_left} {'try' if tries_left == 1 else 'tries'} left for 15 min."


class SignInPage(LoginView):
    template_name = "sign_in.html"
    authentication_form = SignInForm
    redirect_authenticated_user = True


class MissionsPage(SignedInPage):
    template_name = "missions.html"


class MissionPage(SignedInPage):
    """The operator's map, for a new mission or a stored one of the user's organisation."""

    template_name = "mission.html"

    def page(self, **kwargs: Any) -> dict[str, Any]:
        mission_id = kwargs.get("mission_id")
        user = self.request.user
        if mission_id and not Mission.objects.filter(id=mission_id, organisation=user.organisation, deleted_at=None).exists():
            raise Http404
        return {
            "mission": str(mission_id) if mission_id else None,
            "extent": ground_extent(),
            "bounds": mission_bounds(mission_id) if mission_id else None,
        } | raster_maps()


class FleetPage(SignedInPage):
    """UAVs, their types and bases."""

    template_name = "fleet.html"
    extra_context = {"section": "fleet"}

    def page(self, **kwargs: Any) -> dict[str, Any]:
        return {"extent": ground_extent()} | raster_maps()
