"""What leaves the program: printed forms, LaTeX, numeric code, figures."""
