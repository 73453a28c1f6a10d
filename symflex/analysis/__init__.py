"""What is asked of a derived transfer function: responses, modes, sensitivities, approximations."""
