"""Registers Django's admin with our site."""

from django.contrib.admin.apps import AdminConfig


class SpanwiseAdminConfig(AdminConfig):
    default_site = "workspace.admin_site.SpanwiseAdminSite"
