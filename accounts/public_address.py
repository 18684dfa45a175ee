"""The one address that links in mails lead to: the installation's, not whatever a request says of itself."""

from django.conf import settings
from django.http import HttpRequest
from django.http.request import split_domain_port

OWN_MACHINE = {"127.0.0.1", "localhost", "[::1]"}


def public_address(request: HttpRequest) -> str:
    """Scheme and host, as `SPANWISE_PUBLIC_ADDRESS` has it.

    Without it the host that was asked for, which is one of `SPANWISE_ALLOWED_HOSTS`: its port counts on one's own machine alone, since
    whoever asks could name another program's.
    """
    if settings.PUBLIC_ADDRESS:
        return str(settings.PUBLIC_ADDRESS)
    host = request.get_host()
    name = split_domain_port(host)[0]
    return f"{'https' if request.is_secure() else 'http'}://{host if name in OWN_MACHINE else name}"
