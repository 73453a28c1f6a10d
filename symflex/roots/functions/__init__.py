"""Functions with kernels: their values in balls and in doubles, as sums of exponentials where they are."""
