"""Users and service accounts of organisations: login, second factors, invitations, tokens and sessions."""
