"""The tutorial: what is learned in which order, and what a trainee has learned."""
