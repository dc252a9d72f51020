"""What leaves a study: tables for other programs, and all that it has of one trainee."""
