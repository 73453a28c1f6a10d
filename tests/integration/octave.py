"""Running exported function files in Octave: one process for all of them."""

import os
import subprocess

import numpy as np

RUN = ["octave", "--no-gui", "--norc", "--quiet", "--no-history"]
ENVIRONMENT = {"OCTAVE_HISTFILE": os.devnull, "GNUTERM": "dumb"}
HEAD = """\
1;
function keep(name, z)
  handle = fopen([name, '.out'], 'w');
  fprintf(handle, '%.17g %.17g\\n', [real(z(:)).'; imag(z(:)).']);
  fclose(handle);
end
function z = given(name)
  handle = fopen([name, '.in'], 'r');
  z = fscanf(handle, '%g %g', [2, Inf]);
  fclose(handle);
  z = complex(z(1, :), z(2, :)).';
end
"""


class Octave:
    """A folder with function files and a script that calls them."""

    def __init__(self, folder):
        self.folder = folder
        self.lines = []
        self.count = 0

    def write(self, name, text):
        (self.folder / f"{name}.m").write_text(text, encoding="utf-8")

    def points(self, values):
        """Return an expression whose value is a column of numbers."""
        self.count += 1
        name = f"points_{self.count}"
        z = np.asarray(values, dtype=complex)
        (self.folder / f"{name}.in").write_text("".join(f"{x.real!r} {x.imag!r}\n" for x in z.tolist()))
        return f"given('{name}')"

    def do(self, line):
        self.lines.append(line)

    def keep(self, expression):
        """Ask for the value of an expression; return its key."""
        self.count += 1
        name = f"value_{self.count}"
        self.do(f"keep('{name}', {expression});")
        return name

    def run(self):
        """Run the script; return what it printed."""
        (self.folder / "all_of_them.m").write_text(HEAD + "\n".join(self.lines) + "\n", encoding="utf-8")
        done = subprocess.run(
            [*RUN, "all_of_them.m"],
            cwd=self.folder,
            env={**os.environ, **ENVIRONMENT},
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        assert "warning:" not in done.stderr, done.stderr
        return done.stdout

    def value(self, key):
        """Return what was asked for."""
        return np.array(
            [
                complex(*map(float, line.split()))
                for line in (self.folder / f"{key}.out").read_text().splitlines()
            ]
        )
