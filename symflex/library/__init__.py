"""What models are made of: elements, blocks and field theories."""
