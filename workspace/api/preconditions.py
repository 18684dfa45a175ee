"""`If-Match` on rows that several users edit, so that no user overwrites a change they have not seen."""

from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse
from rest_framework.request import Request

from workspace.api.errors import ApiProblem

IF_MATCH_REQUIRED = OpenApiParameter(
    "If-Match", str, OpenApiParameter.HEADER, required=True, description="the ETag as last seen, or * for whatever is there"
)
PRECONDITION_ANSWERS = {
    412: OpenApiResponse(description="Somebody else has changed it since; `details.current` is how it is now."),
    428: OpenApiResponse(description="If-Match is missing."),
}


def etag_of(revision: int) -> dict[str, str]:
    return {"ETag": f'"{revision}"'}


def need_if_match(request: Request) -> None:
    """Raise ApiProblem 428 without the header."""
    if "If-Match" not in request.headers:
        raise ApiProblem(428, "if_match_missing", _("Say with If-Match which revision you have seen: its ETag, or * for any."))


def expected_revision(request: Request) -> int | None:
    """Return the revision that If-Match names; None for any (*). Raises ApiProblem 428 without the header, 412 for a foreign ETag."""
    need_if_match(request)
    text = request.headers["If-Match"].strip().removeprefix("W/").strip('"')
    if text == "*":
        return None
    if not (text.isascii() and text.isdigit() and len(text) < 10):
        raise ApiProblem(412, "changed", "If-Match is not an ETag that this address gave.")
    return int(text)
