"""Pictures: how many colours one has, and those for the documentation, in light and dark, asked for with SPANWISE_SCREENSHOTS=1."""

import base64
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


CANVAS_COLOURS = """(canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    const seen = new Set();
    for (let at = 0; at < data.length; at += 4) seen.add(data[at] << 16 | data[at + 1] << 8 | data[at + 2]);
    return seen.size;
}"""
PICTURE_COLOURS = f"""async (encoded) => {{
    const bytes = Uint8Array.from(atob(encoded), (character) => character.charCodeAt(0));
    const image = await createImageBitmap(new Blob([bytes]));
    const canvas = Object.assign(document.createElement("canvas"), {{ width: image.width, height: image.height }});
    canvas.getContext("2d").drawImage(image, 0, 0);
    return ({CANVAS_COLOURS})(canvas);
}}"""


def colours_of(page: Page, png: bytes) -> int:
    """Number of different colours of a picture; 1 if it is blank."""
    return int(page.evaluate(PICTURE_COLOURS, base64.b64encode(png).decode()))
