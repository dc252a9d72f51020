"""Die Sätze des Simulators auf Deutsch."""

GERMAN = {}
