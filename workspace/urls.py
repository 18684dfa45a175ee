"""URLs of jobs under /api/v1/."""

from django.urls import path

from workspace.jobs import views

urlpatterns = [
    path("jobs", views.JobList.as_view(), name="api-jobs"),
    path("jobs/<uuid:job_id>", views.JobDetail.as_view(), name="api-job"),
    path("jobs/<uuid:job_id>/cancel", views.JobCancel.as_view(), name="api-job-cancel"),
]
