"""Pictures for the documentation, in light and dark, where they are asked for with SPANWISE_SCREENSHOTS=1."""

import os
from collections.abc import Callable

from playwright.sync_api import Page

Picture = Callable[[Page, str], None]
HAS_PICTURES = os.environ.get("SPANWISE_SCREENSHOTS") == "1"
THEMES = ("dark", "light") if HAS_PICTURES else ()


def in_both_themes(page: Page, picture: Picture, name: str) -> None:
    for theme in THEMES:
        page.emulate_media(color_scheme=theme)
        page.locator("#map[data-idle]").wait_for(state="attached")
        picture(page, f"{name}-{theme}")
