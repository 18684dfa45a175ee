"""Zone files in each dialect as zone records."""
