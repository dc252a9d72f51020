"""Making scenarios: task proposals, checks and plans."""
