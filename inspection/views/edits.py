"""What the endpoints of assets and zones share: responses with ETag, creating, changing and deleting, and conflicts."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from django.db import transaction
from django.http import Http404
from django.urls import reverse
from django.utils.translation import gettext as _
from rest_framework.response import Response
from rest_framework.serializers import Serializer

from inspection.models import Asset, NoFlyZone
from inspection.selectors import asset_with_geometry, references_of, zones
from inspection.selectors.history import NEWEST_FIRST, changes_of
from inspection.selectors.register.assets import last_inspections
from inspection.serializers.assets import asset_detail_feature
from inspection.serializers.zones import zone_detail_feature
from inspection.services import StaleRevision, WrongGeometry
from inspection.services.curation import ExternalIdTaken
from inspection.services.history import CannotUndo
from workspace.admin_pages.author_names import author_name
from workspace.api.errors import ApiProblem
from workspace.api.preconditions import etag_of, expected_revision
from workspace.api.signed_in import SignedInRequest
from workspace.models import User

_Row = TypeVar("_Row", Asset, NoFlyZone)


@contextmanager
def edits(user: User, current: Callable[[], dict[str, Any] | None]) -> Iterator[None]:
    """Translate the errors of the curation services to responses; `current` returns the current feature for a client with an old one."""
    try:
        yield
    except StaleRevision as error:
        last = changes_of(error.subject, error.key or 0).order_by(*NEWEST_FIRST).first()
        who = (last and author_name(last.actor, user)) or "an import"
        details = {"current": current(), "changed_by": who, "changed_at": last and last.recorded_at}
        raise ApiProblem(
            412, "changed", _("Changed by %(who)s in the meantime; nothing of yours was stored.") % {"who": who}, details=details
        ) from error
    except ExternalIdTaken as error:
        message = _("Another asset has this external id.")
        raise ApiProblem(409, "external_id_taken", message, details={"external_id": [message]}) from error
    except WrongGeometry as error:
        raise ApiProblem(400, "invalid_geometry", str(error)) from error
    except CannotUndo as error:
        raise ApiProblem(409, "cannot_undo", str(error)) from error


@dataclass(frozen=True)
class Curated(Generic[_Row]):
    """One kind of row that curators edit: reading, validation, storing and deletion."""

    model: type[_Row]
    serializer: type[Serializer]
    endpoint: str  # the URL name of one row
    now: Callable[[User, int], dict[str, Any] | None]
    save: Callable[..., _Row]  # of a row, values of the request, actor and expected_revision
    delete: Callable[..., None]  # of a row, actor and expected_revision

    def drawn(self, request: SignedInRequest) -> Response:
        """Respond to a POST of a new row."""
        body = self.serializer(data=request.data)
        body.is_valid(raise_exception=True)
        with edits(request.user, lambda: None), transaction.atomic():
            row = self.save(self.model(), dict(body.validated_data), actor=request.user, expected_revision=None)
        response = answer(self.now(request.user, row.pk))
        response.status_code = 201
        response["Location"] = reverse(self.endpoint, args=[row.pk])
        return response

    def corrected(self, request: SignedInRequest, key: int) -> Response:
        """Respond to a PATCH with If-Match."""
        revision, row = expected_revision(request), self._row(key)
        body = self.serializer(row, data=request.data, partial=True)
        body.is_valid(raise_exception=True)
        with edits(request.user, lambda: self.now(request.user, key)), transaction.atomic():
            self.save(row, dict(body.validated_data), actor=request.user, expected_revision=revision)
        return answer(self.now(request.user, key))

    def removed(self, request: SignedInRequest, key: int) -> Response:
        """Respond to a DELETE with If-Match."""
        revision = expected_revision(request)
        with edits(request.user, lambda: self.now(request.user, key)):
            self.delete(self._row(key), actor=request.user, expected_revision=revision)
        return Response(status=204)

    def _row(self, key: int) -> _Row:
        try:
            return self.model._default_manager.get(pk=key)
        except self.model.DoesNotExist as error:
            raise Http404 from error


def with_values(row: _Row, values: dict[str, Any]) -> _Row:
    for name, value in values.items():
        setattr(row, name, value)
    return row


def asset_now(user: User, asset_id: int) -> dict[str, Any] | None:
    """Return the asset as the user's organisation sees it."""
    try:
        asset = asset_with_geometry(asset_id)
    except Asset.DoesNotExist:
        return None
    organisation, keys = user.organisation_id, [asset_id]
    return asset_detail_feature(asset, references_of(organisation, keys).get(asset_id), last_inspections(organisation, keys).get(asset_id))


def zone_now(user: User, zone_id: int) -> dict[str, Any] | None:
    try:
        return zone_detail_feature(zones().get(pk=zone_id))
    except NoFlyZone.DoesNotExist:
        return None


def answer(feature: dict[str, Any] | None) -> Response:
    if feature is None:
        raise Http404
    return Response(feature, headers=etag_of(feature["properties"]["revision"]))
