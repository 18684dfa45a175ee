"""Implementation of ./run and ./check: packages, private servers, supervision."""
