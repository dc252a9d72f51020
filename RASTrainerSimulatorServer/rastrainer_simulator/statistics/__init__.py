"""Paired tests, learning and clusters, without any knowledge of trials."""
