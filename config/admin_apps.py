"""Registers Django's admin with our site; config/urls.py discovers its pages, which programs without URLs need not load."""

from django.contrib.admin.apps import SimpleAdminConfig


class SpanwiseAdminConfig(SimpleAdminConfig):
    default_site = "workspace.admin_pages.site.SpanwiseAdminSite"
