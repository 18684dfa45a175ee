"""S9: plain HTTP is led to TLS, HSTS is said, old versions are refused, and the certificate is replaced again and again under load."""

import hashlib
import http.client
import ssl
import time
import warnings
from collections.abc import Callable

from tests.chaos.asking import Askers, Client
from tests.chaos.experiment import Course, main
from tests.chaos.plans import planner, reader
from tests.chaos.site import ONLY_WEB, Site, demo_site, wait_until

SWAPS, SHORT_SWAPS = 5, 2
BETWEEN_S = 4.0
CLIENTS = 6
HSTS_S = 31_536_000


def run(course: Course) -> None:
    with demo_site("certificates", ONLY_WEB) as site:
        _redirects(course, site)
        _versions(course, site)
        _swaps(course, site)


def _redirects(course: Course, site: Site) -> None:
    connection = http.client.HTTPConnection("localhost", site.installation.plain_port, timeout=30)
    found = []
    for path in ("/", "/api/v1/missions", "/missions/new?x=1"):
        connection.request("GET", path)
        answer = connection.getresponse()
        answer.read()
        found.append((answer.status, answer.getheader("Location", "")))
    connection.close()
    are_led = all(status in (301, 308) and address.startswith("https://localhost") for status, address in (found[0], found[2]))
    are_led &= found[1][0] in (301, 308, 403)  # a program that sends its token in the clear is better refused than led on
    course.record(
        "plain HTTP",
        f"{', '.join(str(status) for status, _ in found)} (page, API, page)",
        "pages led to https, the API led or refused",
        are_led,
    )
    stated = site.client().ask("GET", "/sign-in").headers.get("strict-transport-security", "")
    age_s = next((int(part.partition("=")[2]) for part in stated.split(";") if part.strip().startswith("max-age")), 0)
    course.record("HSTS", stated or "not said", f"max-age of {HSTS_S:,} s or more", age_s >= HSTS_S)


def _versions(course: Course, site: Site) -> None:
    taken = {
        version.name: _is_taken(site, version)
        for version in (ssl.TLSVersion.TLSv1, ssl.TLSVersion.TLSv1_1, ssl.TLSVersion.TLSv1_2, ssl.TLSVersion.TLSv1_3)
    }
    expected = {"TLSv1": False, "TLSv1_1": False, "TLSv1_2": True, "TLSv1_3": True}
    reported = ", ".join(f"{name} {'taken' if is_taken else 'refused'}" for name, is_taken in taken.items())
    course.record("versions of TLS", reported, "1.2 and 1.3 alone", taken == expected)


def _is_taken(site: Site, version: ssl.TLSVersion) -> bool:
    context = site.installation.trust()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        context.minimum_version = ssl.TLSVersion.TLSv1
        context.set_ciphers("ALL:@SECLEVEL=0")  # so that it is the server that refuses
        context.minimum_version = context.maximum_version = version
    connection = http.client.HTTPSConnection("localhost", site.installation.port, timeout=30, context=context)
    try:
        connection.request("GET", "/healthz")
        return connection.getresponse().status == 200
    except (ssl.SSLError, ConnectionError):
        return False
    finally:
        connection.close()


def _certificate(site: Site) -> str:
    """Of a new connection, as a hash."""
    pem = ssl.get_server_certificate(("localhost", site.installation.port))
    return hashlib.sha256(pem.encode()).hexdigest()


def _swaps(course: Course, site: Site) -> None:
    swaps = SHORT_SWAPS if course.is_short else SWAPS
    seen, waits_s = [_certificate(site)], []
    clients: list[Client] = []

    def question(number: int) -> Callable[[], str]:
        keeps = number % 2 == 0  # the others shake hands each time
        client = site.client(number, keeps=keeps)
        clients.append(client)
        return planner(site, client, course.seed + number) if number % 3 == 0 else reader(client)

    with Askers(question, CLIENTS, pause_s=0.05) as askers:
        for _ in range(swaps):
            time.sleep(BETWEEN_S * course.chance.uniform(0.5, 1.5))
            site.installation.renew_certificate()
            waits_s.append(wait_until(lambda: _certificate(site) != seen[-1], "the new certificate"))
            seen.append(_certificate(site))
        time.sleep(BETWEEN_S)
    dropped = askers.counted.total() - askers.counted["200"]
    reported = f"{dropped} of {askers.counted.total():,} requests dropped at {swaps} swaps, {len(set(seen))} certificates seen"
    reported += f", {sum(client.opened_again for client in clients)} asked again over a kept connection that was closed"
    reported += f", the new one within {max(waits_s):.1f} s"
    course.record(
        "a new certificate under load",
        reported + (f": {askers.faults[:2]}" if dropped else ""),
        "0 dropped",
        dropped == 0 and len(set(seen)) == swaps + 1,
    )


if __name__ == "__main__":
    main(run)
