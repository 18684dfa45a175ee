"""URLs of media and findings under /api/v1/."""

from django.urls import path

from results.views.media import MediaList, MediaLookup, MediaUsed, MediumDetail, MediumFile, MediumPreview
from results.views.uploads import MediaUploadDetail, MediaUploads

urlpatterns = [
    path("media", MediaList.as_view(), name="api-media"),
    path("media/lookup", MediaLookup.as_view(), name="api-media-lookup"),
    path("media/use", MediaUsed.as_view(), name="api-media-use"),
    path("media/<uuid:medium_id>", MediumDetail.as_view(), name="api-medium"),
    path("media/<uuid:medium_id>/file", MediumFile.as_view(), name="api-medium-file"),
    path("media/<uuid:medium_id>/previews/<int:edge>", MediumPreview.as_view(), name="api-medium-preview"),
    path("media-uploads", MediaUploads.as_view(), name="api-media-uploads"),
    path("media-uploads/<uuid:media_upload_id>", MediaUploadDetail.as_view(), name="api-media-upload"),
]
