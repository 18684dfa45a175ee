"""Text of XML elements."""

import re
from xml.sax.saxutils import escape

FORBIDDEN = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")  # XML 1.0, 2.2


def xml_text(text: str) -> str:
    """Return the text escaped for an element, without characters that XML cannot contain."""
    return escape(FORBIDDEN.sub("", text))
