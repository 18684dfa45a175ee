"""Users of a load test share one TLS context, whatever their client asks for."""

import ssl
from pathlib import Path

from deploy.load.certificates import make_authority
from deploy.load.trust import trusting


def test_whatever_authorities_the_client_brings_along_all_users_have_one_context_that_trusts_ours_alone(tmp_path: Path) -> None:
    trust = trusting(str(make_authority(tmp_path)))
    ours = trust()
    assert trust(ssl.get_default_verify_paths().cafile) is ours
    assert trust(cafile="a list that is not there") is ours
    assert [dict(pair[0] for pair in one["subject"])["commonName"] for one in ours.get_ca_certs()] == ["Load test"]
    assert ours.verify_mode is ssl.CERT_REQUIRED and ours.check_hostname
