"""The domain of RASTrainer: registration, scoring, tasks, protocol and study, on numpy alone."""

__version__ = "0.2.0"
