"""All URLs of the program `uav-link`."""

from django.urls import include, path

urlpatterns = [path("api/v1/uav-link/", include("telemetry.uav_link_urls"))]

handler400 = "config.error_pages.bad_request"
handler403 = "config.error_pages.permission_denied"
handler404 = "config.error_pages.not_found"
handler500 = "config.error_pages.server_error"
