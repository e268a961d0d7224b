"""Networks of learned policies and their weight files."""
