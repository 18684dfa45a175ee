"""Screenshots of a run with SPANWISE_SCREENSHOTS=1, those that documents show, and the number of colours of a picture."""

import base64
import io
import os
import re
from collections.abc import Callable
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page

Picture = Callable[[Page, str], None]
PROJECT_DIR = Path(__file__).resolve().parents[2]
ALL_PICTURES = PROJECT_DIR / "var" / "screenshots"
SHOWN_PICTURES = PROJECT_DIR / "docs" / "screenshots"
MAX_PICTURE_BYTES = 120_000
HAS_PICTURES = os.environ.get("SPANWISE_SCREENSHOTS") == "1"
THEMES = ("dark", "light") if HAS_PICTURES else ()


def shown_names() -> set[str]:
    """Return the names of the pictures in docs/screenshots that README.md or a document shows."""
    documents = [PROJECT_DIR / "README.md", *(PROJECT_DIR / "docs").rglob("*.md")]
    return {name for path in documents for name in re.findall(r"screenshots/([\w-]+)\.webp", path.read_text())}


def smallest_webp(picture: Image.Image) -> bytes:
    """Encode a picture without loss, or else with the best quality of 95, 90 and 85, in at most MAX_PICTURE_BYTES."""
    for options in ({"lossless": True}, {"quality": 95}, {"quality": 90}, {"quality": 85}):
        encoded = io.BytesIO()
        picture.convert("RGB").save(encoded, "WEBP", method=6, **options)
        if encoded.tell() <= MAX_PICTURE_BYTES:
            break
    return encoded.getvalue()


def save_picture(png: bytes, name: str) -> None:
    """Write a screenshot below var/, and below docs/ if a document shows it."""
    ALL_PICTURES.mkdir(parents=True, exist_ok=True)
    (ALL_PICTURES / f"{name}.png").write_bytes(png)
    if name in shown_names():
        (SHOWN_PICTURES / f"{name}.webp").write_bytes(smallest_webp(Image.open(io.BytesIO(png))))


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
