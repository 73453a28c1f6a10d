"""Generated code: from a transfer function to a verified program, and from that to a file of some language.

- ``program``: programs in no language, built, scheduled and measured against ball arithmetic
- ``export``: the driver; programs are chosen, and handed to a language as the contents of a file
- ``infix``, ``module_text``: what languages share
- ``python``, ``c``, ``julia``, ``matlab``, ``javascript``: a language each
- ``sources``: the functions that generated code calls, in files of its language
- ``state_space``, ``latex``: what is made otherwise, state equations and LaTeX documents
- ``exporters``: the registry
"""
