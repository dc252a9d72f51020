"""What a trainee is told after a trial: score, touches, what to improve, progress."""
