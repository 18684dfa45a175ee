"""What the machine needs: system packages, Python libraries, a database cluster."""
