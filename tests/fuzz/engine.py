"""One target under atheris: ``python -m tests.fuzz.engine [--unguided] NAME FOLDER [libFuzzer's options]``.

Unguided, only the target itself is instrumented: that is several times as fast, and finds nothing deep by
itself, so it mutates every input of the corpus that guided runs left in the folder. An input that fails is
kept there, and the run goes on; of failures at one place the first is kept.
"""

import sys
import traceback
from hashlib import sha256
from importlib import import_module
from pathlib import Path

UNGUIDED = "--unguided"
LIMITS = (
    "-timeout=120",
    "-report_slow_units=120",
    "-rss_limit_mb=2000",
    "-max_len=5000",
    "-print_final_stats=1",
)


def main(arguments):
    """Fuzz a target until libFuzzer ends the process."""
    import atheris

    is_guided = arguments[0] != UNGUIDED
    name, folder, *options = arguments if is_guided else arguments[1:]
    target_name = f"tests.fuzz.target_{name}"
    packages = import_packages(target_name) if is_guided else (target_name, "tests.fuzz.measured")
    with atheris.instrument_imports(include=list(packages)):
        target = import_module(target_name)
    seen = set()

    def one(data):
        try:
            target.run(data)
        except Exception as error:  # noqa: BLE001 - what is not typed is what is looked for
            at = traceback.extract_tb(error.__traceback__)[-1]
            place = (type(error), at.filename, at.lineno)
            if place not in seen:
                seen.add(place)
                file = Path(folder) / sha256(data).hexdigest()[:16]
                file.write_bytes(data)
                traceback.print_exc()
                print(f"kept {file}", file=sys.stderr)

    corpus = Path(folder) / "corpus"
    corpus.mkdir(exist_ok=True)
    for i, seed in enumerate(target.seeds()):
        (corpus / f"seed-{i}").write_bytes(seed)
    if not is_guided:
        options = ["-keep_seed=1", *options]
    atheris.Setup([target_name, *LIMITS, *options, f"-artifact_prefix={folder}/", str(corpus)], one)
    atheris.Fuzz()


def import_packages(target_name):
    """Return the packages a target names, read without importing it: imports are to be instrumented."""
    import ast

    tree = ast.parse(
        Path(__file__).with_name(target_name.rpartition(".")[2] + ".py").read_text(encoding="utf-8")
    )
    for node in tree.body:
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "ROOMS":
            return ast.literal_eval(node.value)
    raise AssertionError(target_name)


if __name__ == "__main__":
    main(sys.argv[1:])
