"""Users and service accounts of organisations: signing in, second factors, invitations, tokens and sessions."""
