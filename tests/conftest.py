"""Settings of all tests: hypothesis without deadlines (kernels compile) and the same every time."""

from hypothesis import settings

settings.register_profile("mjforage", deadline=None, derandomize=True)
settings.load_profile("mjforage")
