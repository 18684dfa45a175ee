"""URLs of the pages of results."""

from django.urls import path

from results.pages import FindingsPage, ReviewPage

urlpatterns = [
    path("findings", FindingsPage.as_view(), name="findings"),
    path("review", ReviewPage.as_view(), name="review"),
]
