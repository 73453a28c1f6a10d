"""Files written whole or not at all, one process at a time; and the examples that come with symflex."""
