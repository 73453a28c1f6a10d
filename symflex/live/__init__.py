"""Pages that prove poles and zeros while a parameter moves."""
