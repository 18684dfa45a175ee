"""What the two commands ./run and ./check are made of: packages, private servers, supervision."""
