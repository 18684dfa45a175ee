"""URLs of the pages of results."""

from django.urls import path

from results.pages import ReviewPage

urlpatterns = [path("review", ReviewPage.as_view(), name="review")]
