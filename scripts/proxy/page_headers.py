"""Headers that every answer of the proxy carries, above all what a page may load."""

from collections.abc import Iterable
from urllib.parse import urlsplit

STRICT_TRANSPORT = "max-age=31536000; includeSubDomains; preload"  # as config/settings.py has it for the application's answers


def origins(addresses: Iterable[str]) -> list[str]:
    """Scheme and host of tile addresses; servers that are told apart by `{s}.` are any in front of the rest."""
    found = set()
    for address in addresses:
        parts = urlsplit(address)
        host = f"*.{parts.netloc[4:]}" if parts.netloc.startswith("{s}.") else parts.netloc
        if parts.scheme in {"http", "https"} and host.removeprefix("*.") and not set(host.removeprefix("*.")) & set(" ;,'\"{}*@"):
            found.add(f"{parts.scheme}://{host}")
    return sorted(found)


def content_security_policy(tile_addresses: Iterable[str] = ()) -> str:
    """What a page may load: everything from here, and raster tiles from the hosts that the settings name."""
    tiles = "".join(f" {origin}" for origin in origins(tile_addresses))
    rules = [
        "default-src 'self'",
        "script-src 'self'",
        "worker-src 'self' blob:",
        "style-src 'self' 'unsafe-inline'",  # MapLibre and Django's admin set style attributes
        f"img-src 'self' data: blob:{tiles}",
        f"connect-src 'self'{tiles}",  # MapLibre fetches tiles
        "font-src 'self'",
        "object-src 'none'",
        "base-uri 'none'",
        "form-action 'self'",
        "frame-ancestors 'none'",
    ]
    return "; ".join(rules)


def headers(tile_addresses: Iterable[str], *, is_https: bool = False) -> str:
    """Headers that every answer carries. nginx inherits none into a block that adds one of its own, so each block has them all."""
    transport = f'\n            add_header Strict-Transport-Security "{STRICT_TRANSPORT}" always;' if is_https else ""
    return f"""\
            add_header Content-Security-Policy "{content_security_policy(tile_addresses)}" always;
            add_header X-Content-Type-Options nosniff always;
            add_header Referrer-Policy strict-origin-when-cross-origin always;
            add_header Permissions-Policy "camera=(), microphone=(), geolocation=(self)" always;{transport}"""
