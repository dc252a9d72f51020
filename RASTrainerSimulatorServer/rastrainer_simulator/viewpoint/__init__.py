"""Where the picture is looked from: the view that the trainee moves, and the best for a touch."""
