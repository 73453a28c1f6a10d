"""Fuzzing: whatever bytes come in, only typed errors come out.

``python -m tests.fuzz --seconds N`` runs all targets, or those named, for N seconds altogether. Each target
is a module ``target_NAME`` with ``ROOMS``, the packages whose branches guide the mutation, ``seeds()``, and
``run(data)``, which raises where the program fails. What once failed is kept in ``failed/NAME`` and run by
the ordinary tests.
"""

TARGETS = (
    "specification",
    "expression",
    "quantity",
    "columns",
    "input_signal",
    "universal_file",
    "network_file",
    "numpy_archive",
    "numpy_array",
    "matlab_file",
    "sweep_file",
    "journal",
    "derivation",
)
