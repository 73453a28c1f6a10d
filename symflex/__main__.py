"""``python -m symflex``."""

from symflex.cli import main

if __name__ == "__main__":
    main()
