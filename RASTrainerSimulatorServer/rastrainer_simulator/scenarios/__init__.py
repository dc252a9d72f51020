"""Make scenarios of heads, check them, and pack them for others."""
