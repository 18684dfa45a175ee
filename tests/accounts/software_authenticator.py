"""An authenticator as WebAuthn describes it, for one credential: its answers can be made wrong in each part."""

import json
from hashlib import sha256
from secrets import token_bytes
from typing import Any

from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.hazmat.primitives.hashes import SHA256
from fido2.cose import ES256, CoseKey
from fido2.utils import websafe_decode, websafe_encode
from fido2.webauthn import AttestationObject, AttestedCredentialData, AuthenticatorData, CollectedClientData

USER_PRESENT, USER_VERIFIED, ATTESTED = 0x01, 0x04, 0x40


class SoftwareAuthenticator:
    def __init__(self, *, origin: str = "http://localhost", verifies_user: bool = True) -> None:
        self.origin, self.host = origin, origin.partition("://")[2].partition(":")[0]
        self.flags = USER_PRESENT | (USER_VERIFIED if verifies_user else 0)
        self.key = ec.generate_private_key(ec.SECP256R1())
        self.credential_id = token_bytes(16)
        self.user_handle = ""
        self.public_key: CoseKey = ES256.from_cryptography_key(self.key.public_key())

    def create(self, options: dict[str, Any]) -> dict[str, Any]:
        """The JSON form of a new credential."""
        self.user_handle = options["user"]["id"]
        client_data = self._client_data(CollectedClientData.TYPE.CREATE, options["challenge"])
        credential = AttestedCredentialData.create(bytes(16), self.credential_id, self.public_key)
        data = AuthenticatorData.create(self._host_hash(), self.flags | ATTESTED, 0, credential)
        attestation = AttestationObject.create("none", data, {})
        response = {"clientDataJSON": websafe_encode(client_data), "attestationObject": websafe_encode(bytes(attestation))}
        return self._credential(response) | {"clientExtensionResults": {"credProps": {"rk": True}}}

    def get(self, options: dict[str, Any]) -> dict[str, Any]:
        """The JSON form of a signed challenge."""
        client_data = self._client_data(CollectedClientData.TYPE.GET, options["challenge"])
        data = AuthenticatorData.create(self._host_hash(), self.flags, 0)
        signature = self.key.sign(bytes(data) + sha256(client_data).digest(), ec.ECDSA(SHA256()))
        return self._credential(
            {
                "clientDataJSON": websafe_encode(client_data),
                "authenticatorData": websafe_encode(bytes(data)),
                "signature": websafe_encode(signature),
                "userHandle": self.user_handle,
            }
        )

    def _client_data(self, kind: str, challenge: str) -> bytes:
        return bytes(CollectedClientData.create(kind, websafe_decode(challenge), self.origin))

    def _host_hash(self) -> bytes:
        return sha256(self.host.encode()).digest()

    def _credential(self, response: dict[str, Any]) -> dict[str, Any]:
        name = websafe_encode(self.credential_id)
        return {"id": name, "rawId": name, "type": "public-key", "response": response, "clientExtensionResults": {}}


def as_form(credential: Any) -> dict[str, str]:
    return {"credential": json.dumps(credential)}
