"""HTTP responses for the errors of planning and missions."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from django.utils.translation import gettext as _
from django.utils.translation import ngettext
from drf_spectacular.utils import OpenApiResponse

from inspection.selectors import NoGraph
from missions.reason_texts import fault_texts
from missions.selectors.fleet import last_change
from missions.services import (
    FleetChanged,
    FleetNameTaken,
    FleetRowInUse,
    GraphOutdated,
    InvalidRequest,
    MissionChanged,
    MissionFrozen,
    NotDeleted,
    NothingToPlan,
    NothingToProve,
    SystemIdQuota,
    SystemIdTaken,
    UavExternalIdTaken,
)
from missions.services.commands.refused import Refused
from operation.reasons import Reason
from workspace.api.errors import ApiProblem
from workspace.api.preconditions import PRECONDITION_ANSWERS
from workspace.reason_texts import reason_text

TAKEN = {409: OpenApiResponse(description="The name, the external id or the MAVLink system id is taken.")}
CHANGE_ANSWERS = {**TAKEN, **PRECONDITION_ANSWERS}
DELETE_ANSWERS = {204: None, 409: OpenApiResponse(description="Something still points at it."), **PRECONDITION_ANSWERS}
RESTORE_CONFLICT = {409: OpenApiResponse(description="It was not deleted, or its name is taken in the meantime.")}
RETRY_AFTER_S = 3  # a new graph is built within seconds


@contextmanager
def fleet_problems(current: Callable[[], Any] | None = None) -> Iterator[None]:
    """Translate errors of fleet services. current: returns the current row for a client with an outdated one; None where it is deleted."""
    try:
        yield
    except FleetNameTaken as error:
        messages = {
            "uav": _("Another UAV has this name."), "uav_type": _("Another type has this name."), "base": _("Another base has this name.")
        }  # fmt: skip
        raise ApiProblem(409, "name_taken", messages[error.subject], details={"name": [messages[error.subject]]}) from error
    except UavExternalIdTaken as error:
        message = _("Another UAV has this external id.")
        raise ApiProblem(409, "external_id_taken", message, details={"external_id": [message]}) from error
    except SystemIdTaken as error:
        message = _("Another UAV has this MAVLink system id.")
        raise ApiProblem(409, "system_id_taken", message, details={"mavlink_system_id": [message]}) from error
    except SystemIdQuota as error:
        message = _("Your organisation has %(limit)s MAVLink system ids already. Retire a UAV to free its id.") % {"limit": error.limit}
        raise ApiProblem(409, "system_id_quota", message, details={"mavlink_system_id": [message]}) from error
    except FleetRowInUse as error:
        raise ApiProblem(409, f"{error.subject}_in_use", _in_use(error)) from error
    except NotDeleted as error:
        raise ApiProblem(409, "not_deleted", _("It was not deleted: there is nothing to bring back.")) from error
    except FleetChanged as error:
        raise _changed(error, current() if current else None) from error


def _in_use(error: FleetRowInUse) -> str:
    if error.subject == "uav":
        return ngettext(
            "A mission uses this UAV. Retire it instead.", "%(count)d missions use this UAV. Retire it instead.", error.users
        ) % {"count": error.users}
    if error.subject == "base":
        return ngettext(
            "A UAV has this base. Give it another one first.", "%(count)d UAVs have this base. Give them another one first.", error.users
        ) % {"count": error.users}
    return ngettext(
        "A UAV is of this type. Give it another one first.", "%(count)d UAVs are of this type. Give them another one first.", error.users
    ) % {"count": error.users}


def _changed(error: FleetChanged, current: Any) -> ApiProblem:
    last = last_change(error.subject, error.key)
    who = last.actor.display_name if last and last.actor else _("a program")
    message = _("Changed by %(who)s in the meantime; nothing of yours was stored.") % {"who": who}
    return ApiProblem(412, "changed", message, details={"current": current, "changed_by": who, "changed_at": last and last.recorded_at})


@contextmanager
def api_problems(*, has_precondition: bool = False) -> Iterator[None]:
    """Translate errors of planning and missions. has_precondition: the request named its revision with If-Match."""
    try:
        yield
    except InvalidRequest as error:
        faults = fault_texts(error)
        place, fault = next(iter(faults.items()))
        details = {where: [what] for where, what in faults.items()}
        raise ApiProblem(400, "invalid", f"{place}: {fault}", details=details) from error
    except NothingToPlan as error:
        raise ApiProblem(400, "nothing_to_plan", _("A mission needs at least one UAV and one target to be planned.")) from error
    except NothingToProve as error:
        message = _("Nothing to look for: the plan is proven, changed by hand or too large, or there is none.")
        raise ApiProblem(409, "nothing_to_prove", message) from error
    except NoGraph as error:
        message = "There is no network to plan on yet: import infrastructure first, or wait until it has been linked."
        raise ApiProblem(503, "no_graph", message, retry_after_s=RETRY_AFTER_S) from error
    except GraphOutdated as error:
        raise ApiProblem(503, "graph_outdated", reason_text(Reason("zones_changing")), retry_after_s=RETRY_AFTER_S) from error
    except MissionChanged as error:
        message = "The mission was changed in the meantime. Load it again."
        raise ApiProblem(412 if has_precondition else 409, "mission_changed", message) from error
    except MissionFrozen as error:
        raise ApiProblem(409, "mission_frozen", _("Only drafts and planned missions can be changed.")) from error


@contextmanager
def refusals() -> Iterator[None]:
    """Translate Refused to a 409 with every reason."""
    try:
        yield
    except Refused as error:
        reasons = [{"code": reason.code, "message": reason.message, "uav": reason.uav} for reason in error.reasons]
        raise ApiProblem(409, error.reasons[0].code, str(error), details={"reasons": reasons}) from error
