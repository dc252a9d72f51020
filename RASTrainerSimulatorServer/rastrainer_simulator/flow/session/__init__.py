"""What every page shares: the session, who trains, and what is chosen."""
