"""Requirements of the machine: system packages, Python libraries, a database cluster."""
