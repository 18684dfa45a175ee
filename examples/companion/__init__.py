"""A companion computer's side of the HTTP link: polls for its route, reports, stores and forwards. Standard library alone."""
