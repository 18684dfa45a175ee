"""What the doors of assets and zones have in common when somebody writes: who may, and the answer to those who come second."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from django.utils.translation import gettext as _

from inspection.selectors.history import NEWEST_FIRST, changes_of
from inspection.services import StaleRevision, WrongGeometry
from inspection.services.asset_references import ExternalIdTaken
from inspection.services.history import CannotUndo
from workspace.admin_pages.author_names import author_name
from workspace.api.errors import ApiProblem
from workspace.models import User


@contextmanager
def edits(user: User, current: Callable[[], dict[str, Any] | None]) -> Iterator[None]:
    """Turns the errors of the curation services into answers; `current` gives the feature as it is now, for whoever was too late."""
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
