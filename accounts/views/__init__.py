"""Endpoints of accounts: the own one, those of an organisation, service accounts and sessions."""
