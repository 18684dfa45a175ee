"""Pages of accounts: login, second factors, passwords and users."""
