"""`rastrainer doctor`: is all there that training needs, and what to do where it is not."""
