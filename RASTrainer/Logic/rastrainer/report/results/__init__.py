"""What the sections and charts are drawn from: comparisons, trends and scores of a study."""
