"""Running exported modules in Julia: one process for all of them."""

import subprocess

import numpy as np

RUN = ["julia", "--startup-file=no", "--history-file=no", "--optimize=1"]
HEAD = """\
function keep(name, z)
    open(name * ".out", "w") do io
        foreach(x -> println(io, real(x), " ", imag(x)), z)
    end
end
function given(name)
    rows = [parse.(Float64, split(line)) for line in readlines(name * ".in")]
    return [complex(r[1], r[2]) for r in rows]
end
"""


class Julia:
    """A folder with modules and a script that calls their functions."""

    def __init__(self, folder):
        self.folder = folder
        self.lines = []
        self.count = 0

    def write(self, name, text):
        (self.folder / f"{name}.jl").write_text(text, encoding="utf-8")
        self.do(f'include("{name}.jl")')

    def points(self, values):
        """Return an expression whose value is a vector of numbers."""
        self.count += 1
        name = f"points_{self.count}"
        z = np.asarray(values, dtype=complex)
        (self.folder / f"{name}.in").write_text("".join(f"{x.real!r} {x.imag!r}\n" for x in z.tolist()))
        return f'given("{name}")'

    def do(self, line):
        self.lines.append(line)

    def keep(self, expression):
        """Ask for the values of an expression; return its key."""
        self.count += 1
        name = f"value_{self.count}"
        self.do(f'keep("{name}", {expression})')
        return name

    def run(self):
        """Run the script; return what it printed."""
        (self.folder / "all_of_them.jl").write_text(HEAD + "\n".join(self.lines) + "\n", encoding="utf-8")
        done = subprocess.run(
            [*RUN, "all_of_them.jl"],
            cwd=self.folder,
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        assert "warning" not in done.stderr.lower(), done.stderr
        return done.stdout

    def value(self, key):
        """Return what was asked for."""
        return np.array(
            [
                complex(*map(float, line.split()))
                for line in (self.folder / f"{key}.out").read_text().splitlines()
            ]
        )
