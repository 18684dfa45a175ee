"""One's organisation: its name and time zone."""

from collections.abc import Mapping
from typing import Any

from django.db import IntegrityError
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from accounts import services
from accounts.identity_provider import identity_provider
from accounts.serializers import OrganisationSerializer
from workspace.api.errors import ApiProblem
from workspace.api.permissions import ADMINISTRATORS, InTheBrowserAlone
from workspace.api.preconditions import IF_MATCH_REQUIRED, PRECONDITION_ANSWERS, etag_of, expected_revision
from workspace.api.signed_in import SignedInRequest
from workspace.models import Organisation


class OwnOrganisation(APIView):
    write_roles = ADMINISTRATORS
    permission_classes = [InTheBrowserAlone]

    @extend_schema(operation_id="get_organisation", summary="One's organisation", responses=OrganisationSerializer)
    def get(self, request: SignedInRequest) -> Response:
        return self._answer(request.user.organisation)

    @extend_schema(
        operation_id="change_organisation",
        summary="Change the name or time zone of one's organisation",
        description="Administrators alone. Pages show times in this zone to users who chose none. Not with a token.",
        parameters=[IF_MATCH_REQUIRED],
        request=OrganisationSerializer,
        responses={
            200: OrganisationSerializer,
            409: OpenApiResponse(description="Another organisation has this name, or the identity provider assigns users by it."),
            **PRECONDITION_ANSWERS,
        },
    )
    def patch(self, request: SignedInRequest) -> Response:
        organisation, revision = request.user.organisation, expected_revision(request)
        body = OrganisationSerializer(organisation, data=request.data, partial=True)
        body.is_valid(raise_exception=True)
        _refuse_name(organisation, body.validated_data)
        try:
            changed = services.change_organisation(
                organisation=organisation, actor=request.user, values=body.validated_data, expected_revision=revision
            )
        except IntegrityError as error:  # another one took the name meanwhile
            raise ApiProblem(409, "name_taken", _("Another organisation has this name.")) from error
        except services.OrganisationChanged as error:
            raise ApiProblem(412, "changed", str(error), details={"current": OrganisationSerializer(error.organisation).data}) from error
        return self._answer(changed)

    @staticmethod
    def _answer(organisation: Organisation) -> Response:
        return Response(OrganisationSerializer(organisation).data, headers=etag_of(organisation.revision))


def _refuse_name(organisation: Organisation, values: Mapping[str, Any]) -> None:
    """Refuse a change of the name by which the identity provider assigns users to organisations."""
    provider = identity_provider()
    if provider is not None and provider.organisation_claim and values.get("name", organisation.name) != organisation.name:
        raise ApiProblem(409, "name_of_provider", _("The identity provider assigns users by this name. It is changed by the operators."))
