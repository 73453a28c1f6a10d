"""What is measured, and what is fitted to it."""
