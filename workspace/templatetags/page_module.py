"""A page's script with all its imports, so that the browser requests everything at once instead of module by module."""

import re
from functools import cache
from posixpath import dirname, join, normpath

from django import template
from django.conf import settings
from django.contrib.staticfiles.storage import staticfiles_storage
from django.utils.html import format_html, format_html_join
from django.utils.safestring import SafeString
from django.utils.translation import get_language

register = template.Library()

IMPORTED = re.compile(r"""^(?:import|export)\s[^;]*?from\s*["']([./][^"']+)["'];|^import\s*["']([./][^"']+)["'];""", re.M)


@register.simple_tag
def page_module(name: str) -> SafeString:
    """`{% page_module "js/missions/main.js" %}`"""
    address = staticfiles_storage.url(name)
    behind = dict.fromkeys((*imported_by(address), *_texts()))
    preloads = format_html_join("\n", '<link rel="modulepreload" href="{}">', ((found,) for found in behind))
    return format_html('{}\n<script type="module" src="{}"></script>', preloads, address)


@register.simple_tag
def catalogue() -> SafeString:
    """`{% catalogue %}` in the head names the scripts' texts in the page's language for static/js/text.js; empty in English."""
    return format_html_join("", '<meta name="catalogue" content="{}">', ((address,) for address in _texts()))


def _texts() -> tuple[str, ...]:
    """Return the address of the scripts' texts in the page's language, compiled by scripts/development/texts.py."""
    language = get_language() or settings.LANGUAGE_CODE
    return () if language.split("-")[0] == "en" else (staticfiles_storage.url(f"js/locale/{language}.js"),)


@cache
def imported_by(address: str) -> tuple[str, ...]:
    """Return the addresses of all imported modules, nearest first; a hashed file's imports never change. Empty before collectstatic."""
    root = settings.STATIC_URL
    found: dict[str, None] = {}
    waiting = [address]
    while waiting:
        module = waiting.pop(0)
        is_ours = module.startswith(f"{root}js/")  # a library is one file
        if not is_ours or not staticfiles_storage.exists(module.removeprefix(root)):
            continue
        with staticfiles_storage.open(module.removeprefix(root)) as file:
            text = file.read().decode()
        for match in IMPORTED.finditer(text):
            target = match[1] or match[2]
            target = target if target.startswith("/") else normpath(join(dirname(module), target))
            if target not in found and target != address:
                found[target] = None
                waiting.append(target)
    return tuple(found)
