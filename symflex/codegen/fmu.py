"""Functional mock-up units: difference equations as a co-simulation of FMI 3.0, with their sources.

Input: a :class:`~symflex.codegen.sampled.StepFile`. Output: an :class:`Export` whose archive contains

    modelDescription.xml                 inputs and outputs with their units, the sample as the fixed step
    sources/fmu.c, buildDescription.xml  the step functions of the C export, and the functions of FMI
    binaries/x86_64-linux/NAME.so        where a C compiler is there

Inputs are held from one sample to the next; delays are exact on the grid of samples. Values of parameters
are those of the file. Source: Modelica Association, Functional Mock-up Interface 3.0, 2022.
"""

from __future__ import annotations

import io
import platform
import re
import shutil
import subprocess
import tempfile
import zipfile
from collections.abc import Mapping
from dataclasses import replace
from hashlib import sha256
from importlib import resources
from pathlib import Path
from xml.sax.saxutils import quoteattr

from symflex.codegen.c.body import KEYWORDS, RESERVED
from symflex.codegen.c.module import COMMENT, prefix_of
from symflex.codegen.c.sampled import c_steps
from symflex.codegen.export import Export
from symflex.codegen.module_text import identifiers
from symflex.codegen.sampled import SampledLanguage, StepFile

OLD = (1980, 1, 1, 0, 0, 0)  # when all files of an archive were written: the same model gives the same bytes
COMPILER = ("cc", "-shared", "-fPIC", "-O2", "-std=c99", "-ffp-contract=off", "-fvisibility=hidden")
TIME = "time"  # the independent variable
NOT_COMPILED = "no C compiler was found: the unit contains sources, but no binary"


def fmu(file: StepFile) -> Export:
    """Return the unit; that no compiler was found is a warning."""
    name = identifiers({"": file.stem or "model"}, {*KEYWORDS, *RESERVED})[""]
    source = _source(file)
    # What the prose of a model does not change.
    statements = re.sub(r"/\*.*?\*/", "", source, flags=re.DOTALL)
    token = sha256(statements.encode("utf-8", "replace")).hexdigest()[:32]
    source = f'#define TOKEN "{token}"\n{source}'
    built = (
        '<?xml version="1.0" encoding="UTF-8"?>\n<fmiBuildDescription fmiVersion="3.0">\n'
        f"  <BuildConfiguration modelIdentifier={quoteattr(name)}>\n"
        '    <SourceFileSet language="C99"><SourceFile name="fmu.c"/></SourceFileSet>\n'
        "  </BuildConfiguration>\n</fmiBuildDescription>\n"
    )
    files = {
        "modelDescription.xml": _description(file, name, token).encode("utf-8", "replace"),
        "sources/buildDescription.xml": built.encode("utf-8", "replace"),
        "sources/fmu.c": source.encode("utf-8", "replace"),
    }
    binary = _compiled(source)
    if binary is not None:
        files[f"binaries/{platform.machine().lower().replace('amd64', 'x86_64')}-linux/{name}.so"] = binary
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as made:
        for path, content in files.items():
            made.writestr(zipfile.ZipInfo(path, OLD), content)
    warnings = [
        f"{what} is called {given} in the unit, whose variables need names of their own"
        for what, given in _variables(file).items()
        if what.split(" ", 1)[1] != given
    ]
    warnings += [] if binary is not None else [NOT_COMPILED]
    return Export(source, tuple(warnings), archive=archive.getvalue(), name=name)


def _places(file: StepFile) -> tuple[list[str], list[str]]:
    """Return the names of inputs and outputs, in the order in which they are used."""
    sources = dict.fromkeys(f.tf.input.name for f in file.functions)
    return list(sources), list(dict.fromkeys(f.tf.output.name for f in file.functions))


def _variables(file: StepFile) -> Mapping[str, str]:
    """Return what ``input u`` and ``output y`` are called; an output may bear the name of an input."""
    inputs, outputs = _places(file)
    wanted = {f"input {name}": name for name in inputs} | {f"output {name}": name for name in outputs}
    return identifiers(wanted, {TIME})


def _source(file: StepFile) -> str:
    steps = c_steps(replace(file, stem=None)).text
    prefix = prefix_of(None)
    inputs, outputs = _places(file)
    states, sums = [], {name: list[str]() for name in outputs}
    for i, function in enumerate(file.functions):
        states.append(f"    {prefix}_{function.name}_state s{i};")
        index = inputs.index(function.tf.input.name)
        sums[function.tf.output.name].append(f"{prefix}_{function.name}_step(&m->s{i}, m->in[{index}])")
    lines = [
        f"#define INPUTS {len(inputs)}",
        f"#define OUTPUTS {len(outputs)}",
        f"#define SAMPLE {float(file.sampling.sample)!r}",
        "",
        "typedef struct {",
        "    double t, in[INPUTS], out[OUTPUTS];",
        *states,
        "} Model;",
        "",
        "static void step_all(Model *m)",
        "{",
        *(f"    m->out[{i}] = {' + '.join(sums[name])};" for i, name in enumerate(outputs)),
        "}",
        "",
    ]
    interface = resources.files("symflex.codegen").joinpath("sources", "fmi3.c").read_text(encoding="utf-8")
    return "\n".join([steps, *lines, interface])


def _description(file: StepFile, name: str, token: str) -> str:
    """Return modelDescription.xml."""
    inputs, outputs = _places(file)
    sample = float(file.sampling.sample)
    model = file.model
    units = {f"input {i.name}": i.unit for i in model.inputs}
    units |= {f"output {o.name}": o.unit for o in model.outputs}
    names = _variables(file)
    used = [u for u in dict.fromkeys(units.get(what, "") for what in names) if u]
    variables = []
    for reference, (what, given) in enumerate(names.items(), 1):
        causality, default = what.split(" ", 1)
        more = f" unit={quoteattr(units[what])}" if units.get(what) else ""
        more += "" if given == default else f" description={quoteattr(what)}"
        start = ' start="0"' if causality == "input" else ""
        variables.append(
            f'    <Float64 name="{given}" valueReference="{reference}" causality="{causality}" '
            f'variability="discrete"{more}{start}/>'
        )
    return "\n".join(
        [
            '<?xml version="1.0" encoding="UTF-8"?>',
            f'<fmiModelDescription fmiVersion="3.0" modelName={quoteattr(model.title or name)}',
            f'  instantiationToken="{token}" generationTool="symflex">',
            f'  <CoSimulation modelIdentifier="{name}" fixedInternalStepSize="{sample!r}"',
            '    canHandleVariableCommunicationStepSize="true" canGetAndSetFMUState="true"/>',
            *(["  <UnitDefinitions>"] if used else []),
            *(f"    <Unit name={quoteattr(u)}/>" for u in used),
            *(["  </UnitDefinitions>"] if used else []),
            f'  <DefaultExperiment startTime="0" stepSize="{sample!r}"/>',
            "  <ModelVariables>",
            f'    <Float64 name="{TIME}" valueReference="0" causality="independent"',
            '      variability="continuous"/>',
            *variables,
            "  </ModelVariables>",
            "  <ModelStructure>",
            *(
                f'    <{kind} valueReference="{len(inputs) + k}"/>'
                for kind in ("Output", "InitialUnknown")
                for k in range(1, len(outputs) + 1)
            ),
            "  </ModelStructure>",
            "</fmiModelDescription>",
            "",
        ]
    )


def _compiled(source: str) -> bytes | None:
    """Return the shared library of a source, ``None`` where there is no compiler, or no Linux."""
    if platform.system() != "Linux" or shutil.which(COMPILER[0]) is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "fmu.c").write_bytes(source.encode("utf-8", "replace"))
        command = [*COMPILER, "fmu.c", "-o", "fmu.so", "-lm"]
        made = subprocess.run(command, cwd=folder, capture_output=True, check=False)
        return Path(folder, "fmu.so").read_bytes() if made.returncode == 0 else None


FMU = SampledLanguage(
    ".fmu",
    "co-simulation unit of FMI 3.0, with sources and, on Linux, a binary",
    fmu,
    COMMENT,
    sorted({*KEYWORDS, *RESERVED}),
)
