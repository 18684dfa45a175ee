"""A page's script with the chunks that it imports, so that the browser requests all of them at once."""

from django import template
from django.conf import settings
from django.contrib.staticfiles.storage import staticfiles_storage
from django.utils.html import format_html, format_html_join
from django.utils.safestring import SafeString
from django.utils.translation import get_language

register = template.Library()


@register.simple_tag
def page_module(name: str) -> SafeString:
    """`{% page_module "js/missions/main.js" %}`"""
    chunks, later = (
        [(f"{settings.STATIC_URL}{path}",) for path in getattr(staticfiles_storage, kind, {}).get(name, [])] for kind in ("chunks", "later")
    )
    preloads = format_html_join("\n", '<link rel="modulepreload" href="{}">', (*chunks, *((address,) for address in _texts())))
    preloads += format_html_join("\n", '<link rel="modulepreload" fetchpriority="low" href="{}">', later)
    return format_html('{}\n<script type="module" src="{}"></script>', preloads, staticfiles_storage.url(name))


@register.simple_tag
def catalogue() -> SafeString:
    """`{% catalogue %}` in the head names the scripts' texts in the page's language for static/js/text.js; empty in English."""
    return format_html_join("", '<meta name="catalogue" content="{}">', ((address,) for address in _texts()))


def _texts() -> tuple[str, ...]:
    """Return the address of the scripts' texts in the page's language, compiled by scripts/development/texts.py."""
    language = get_language() or settings.LANGUAGE_CODE
    return () if language.split("-")[0] == "en" else (staticfiles_storage.url(f"js/locale/{language}.js"),)
