"""What deploy/prove_image.py is made of."""
