"""Pages of accounts: signing in, second factors, passwords and users."""
