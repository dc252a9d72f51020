"""NASA-TLX, SSQ and SUS: their items and scores."""
