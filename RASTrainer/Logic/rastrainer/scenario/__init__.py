"""What is trained on: tasks, plan, set-up, package and library."""
