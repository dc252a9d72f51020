"""How often the tests of the domain draw."""

from hypothesis import settings

settings.register_profile("seeded", derandomize=True, deadline=None, max_examples=300)
settings.load_profile("seeded")
