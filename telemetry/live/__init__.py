"""Live pages' end on the server: rows are followed once a process and organisation, whoever many pages are open."""
