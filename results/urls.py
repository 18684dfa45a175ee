"""URLs of media and findings under /api/v1/."""

from django.urls import path, register_converter

from results.views.finding_files import KINDS, FindingFile
from results.views.findings import (
    FindingCategories,
    FindingComments,
    FindingDetail,
    FindingEvidence,
    FindingEvidenceDetail,
    FindingHistory,
    FindingList,
    FindingObservations,
    FindingsLookAgain,
)
from results.views.media import MediaList, MediaLookup, MediaUsed, MediumDetail, MediumFile, MediumPreview
from results.views.uploads import MediaUploadDetail, MediaUploads


class FindingKindConverter:
    """The extension of a file of findings."""

    regex = "|".join(KINDS)

    def to_python(self, value: str) -> str:
        return value

    def to_url(self, value: str) -> str:
        return value


register_converter(FindingKindConverter, "finding_kind")

urlpatterns = [
    path("media", MediaList.as_view(), name="api-media"),
    path("media/lookup", MediaLookup.as_view(), name="api-media-lookup"),
    path("media/use", MediaUsed.as_view(), name="api-media-use"),
    path("media/<uuid:medium_id>", MediumDetail.as_view(), name="api-medium"),
    path("media/<uuid:medium_id>/file", MediumFile.as_view(), name="api-medium-file"),
    path("media/<uuid:medium_id>/previews/<int:edge>", MediumPreview.as_view(), name="api-medium-preview"),
    path("media-uploads", MediaUploads.as_view(), name="api-media-uploads"),
    path("media-uploads/<uuid:media_upload_id>", MediaUploadDetail.as_view(), name="api-media-upload"),
    path("finding-categories", FindingCategories.as_view(), name="api-finding-categories"),
    path("findings", FindingList.as_view(), name="api-findings"),
    path("findings.<finding_kind:kind>", FindingFile.as_view(), name="api-finding-file"),
    path("findings/look-again", FindingsLookAgain.as_view(), name="api-findings-look-again"),
    path("findings/<uuid:finding_id>", FindingDetail.as_view(), name="api-finding"),
    path("findings/<uuid:finding_id>/evidence", FindingEvidence.as_view(), name="api-finding-evidence"),
    path("findings/<uuid:finding_id>/evidence/<int:evidence_id>", FindingEvidenceDetail.as_view(), name="api-finding-evidence-detail"),
    path("findings/<uuid:finding_id>/observations", FindingObservations.as_view(), name="api-finding-observations"),
    path("findings/<uuid:finding_id>/comments", FindingComments.as_view(), name="api-finding-comments"),
    path("findings/<uuid:finding_id>/history", FindingHistory.as_view(), name="api-finding-history"),
]
