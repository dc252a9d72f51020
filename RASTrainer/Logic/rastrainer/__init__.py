"""The domain of RASTrainer: registration, scoring, tasks, protocol, study; numpy and scipy only."""

__version__ = "0.2.0"
