"""Endpoints of accounts: one's own, those of an organisation, service accounts and sessions."""
