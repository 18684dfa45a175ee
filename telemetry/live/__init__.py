"""Server side of live pages: follows rows once per process and organisation, for any number of open pages."""
