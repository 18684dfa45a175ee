"""All URLs of the program."""

from django.contrib import admin
from django.urls import URLPattern, URLResolver, include, path

from workspace.api.api_document import api_document
from workspace.api.api_page import ApiPage

admin.autodiscover()
urlpatterns: list[URLPattern | URLResolver] = [
    path("api/v1/", include("missions.urls")),  # first, as the most frequent: URLs are tried in order
    path("api/schema", api_document, name="schema"),
    path("api/docs", ApiPage.as_view(), name="api-docs"),
    path("api/v1/", include("workspace.urls")),
    path("api/v1/", include("accounts.urls")),
    path("api/v1/", include("inspection.urls")),
    path("api/v1/", include("telemetry.urls")),
    path("api/v1/", include("results.urls")),
    path("api/v1/", include("simulation.urls")),
    path("", include("accounts.page_urls")),
    path("", include("inspection.page_urls")),
    path("", include("missions.page_urls")),
    path("", include("telemetry.page_urls")),
    path("", include("results.page_urls")),
    path("admin/", admin.site.urls),
]

handler400 = "config.error_pages.bad_request"
handler403 = "config.error_pages.permission_denied"
handler404 = "config.error_pages.not_found"
handler500 = "config.error_pages.server_error"
