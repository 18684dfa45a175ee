"""Registers Django's admin with our site; config/urls.py looks for its pages, which programs without addresses need not load."""

from django.contrib.admin.apps import SimpleAdminConfig


class SpanwiseAdminConfig(SimpleAdminConfig):
    default_site = "workspace.admin_pages.site.SpanwiseAdminSite"
