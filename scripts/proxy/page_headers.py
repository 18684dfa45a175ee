"""Headers of all of the proxy's responses, above all what a page may load."""

from collections.abc import Iterable
from urllib.parse import urlsplit

STRICT_TRANSPORT = "max-age=31536000; includeSubDomains; preload"  # as in config/settings.py for the application's responses


def origins(addresses: Iterable[str]) -> list[str]:
    """Return scheme and host of tile addresses; a `{s}.` subdomain becomes a wildcard."""
    found = set()
    for address in addresses:
        parts = urlsplit(address)
        host = f"*.{parts.netloc[4:]}" if parts.netloc.startswith("{s}.") else parts.netloc
        if parts.scheme in {"http", "https"} and host.removeprefix("*.") and not set(host.removeprefix("*.")) & set(" ;,'\"{}*@"):
            found.add(f"{parts.scheme}://{host}")
    return sorted(found)


def content_security_policy(tile_addresses: Iterable[str] = ()) -> str:
    """Return what a page may load: everything from this host, and raster tiles from the hosts in the settings."""
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
    """Return the headers of every response. nginx inherits none into a block that adds its own, so each block needs all of them."""
    transport = f'\n            add_header Strict-Transport-Security "{STRICT_TRANSPORT}" always;' if is_https else ""
    return f"""\
            add_header Content-Security-Policy "{content_security_policy(tile_addresses)}" always;
            add_header X-Content-Type-Options nosniff always;
            add_header Referrer-Policy strict-origin-when-cross-origin always;
            add_header Permissions-Policy "camera=(), microphone=(), geolocation=(self)" always;{transport}"""
