"""Settings for random examples in the tests of the domain."""

from hypothesis import settings

settings.register_profile("seeded", derandomize=True, deadline=None, max_examples=100)
settings.load_profile("seeded")
