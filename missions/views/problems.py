"""What the errors of planning and missions are as answers."""

from collections.abc import Iterator
from contextlib import contextmanager

from django.utils.translation import gettext as _

from inspection.selectors import NoGraph
from missions.services import GraphOutdated, InvalidRequest, MissionChanged, MissionFrozen, NothingToPlan
from missions.services.commands.refused import Refused
from workspace.api.errors import ApiProblem

RETRY_AFTER_S = 3  # a new graph is built within seconds


@contextmanager
def api_problems(*, has_precondition: bool = False) -> Iterator[None]:
    """has_precondition: the request said with If-Match which revision it means."""
    try:
        yield
    except InvalidRequest as error:
        place, fault = next(iter(error.faults.items()))
        details = {where: [what] for where, what in error.faults.items()}
        raise ApiProblem(400, "invalid", f"{place}: {fault}", details=details) from error
    except NothingToPlan as error:
        raise ApiProblem(400, "nothing_to_plan", _("A mission needs at least one UAV and one target to be planned.")) from error
    except NoGraph as error:
        message = "There is no network to plan on yet: import infrastructure first, or wait until it has been linked."
        raise ApiProblem(503, "no_graph", message, retry_after_s=RETRY_AFTER_S) from error
    except GraphOutdated as error:
        raise ApiProblem(503, "graph_outdated", str(error), retry_after_s=RETRY_AFTER_S) from error
    except MissionChanged as error:
        message = "The mission was changed in the meantime. Load it again."
        raise ApiProblem(412 if has_precondition else 409, "mission_changed", message) from error
    except MissionFrozen as error:
        raise ApiProblem(409, "mission_frozen", _("Only drafts and planned missions can be changed.")) from error


@contextmanager
def refusals() -> Iterator[None]:
    """409 with every reason why something is not done."""
    try:
        yield
    except Refused as error:
        reasons = [{"code": reason.code, "message": reason.message, "uav": reason.uav} for reason in error.reasons]
        raise ApiProblem(409, error.reasons[0].code, str(error), details={"reasons": reasons}) from error
