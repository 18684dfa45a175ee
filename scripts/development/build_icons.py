"""Gather the icons that the pages use into one sprite: lucide's named in lucide.txt, and our own beside that list."""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LUCIDE = ROOT / "node_modules" / "lucide-static" / "icons"
OWN = ROOT / "static" / "img" / "icons"
SPRITE = ROOT / "node_modules" / ".spanwise" / "icons.svg"


def symbol(name: str, svg: str) -> str:
    """Return an SVG file as a symbol, without stroke and colour, which the style sheet sets."""
    view_box = re.search(r'viewBox="([^"]+)"', svg)
    drawing = re.search(r"<svg[^>]*>(.*)</svg>", svg, re.S)
    if view_box is None or drawing is None:
        raise ValueError(f"icon {name} is not an SVG drawing")
    shapes = " ".join(drawing[1].split())
    return f'<symbol id="{name}" viewBox="{view_box[1]}">{shapes}</symbol>'


def main() -> int:
    names = (OWN / "lucide.txt").read_text().split()
    files = [LUCIDE / f"{name}.svg" for name in names] + sorted(OWN.glob("*.svg"))
    missing = [file.stem for file in files if not file.exists()]
    if missing:
        print(f"icons not found: {', '.join(missing)}", file=sys.stderr)
        return 1
    symbols = "\n".join(symbol(file.stem, file.read_text()) for file in files)
    SPRITE.parent.mkdir(parents=True, exist_ok=True)
    SPRITE.write_text(f'<svg xmlns="http://www.w3.org/2000/svg">\n{symbols}\n</svg>\n')
    print(f"{len(files)} icons in {SPRITE.relative_to(ROOT)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
