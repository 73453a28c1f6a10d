BEAM = """
symflex = 1
parameters = { E = 1, I = 1, rho = 1, A = 1, l = "1 m" }
inputs.F = { force = "q" }
outputs.X = "q"
[elements]
base = { type = "fixed", at = "p" }
arm  = { type = "beam", between = ["p", "q"], E = "E", I = "I", rho = "rho", A = "A", l = "l" }
"""


def test_a_length_of_zero_is_refused_before_anything_is_solved(shell):
    for over in ("l=0,1", "l=0:1:lin:3"):
        (shell.folder / "beam.toml").write_text(BEAM)
        done = shell("sweep", "beam.toml", "--over", over, "--modes", "2", "-o", "out.nc")
        assert (done.code, done.out) == (2, ""), over
        assert "error[SF209]: parameter 'l' is 0" in done.err, over
        assert not list(shell.folder.glob("out.nc*")), over


def test_too_many_points_exceed_a_budget(shell):
    done = shell("sweep", "x.toml", "--over", "k=1:2:lin:1000000000")
    assert done.code == 5
    assert "error[SF507]" in done.err and "1000000000" in done.err


def test_only_options_that_a_sweep_has_are_named(shell):
    done = shell("sweep", "x.toml", "--over", "k=1,2", "--modes", "2", "--band", "1", "50")
    assert done.code == 2
    assert "--modes" in done.err and "--band" in done.err
    assert "--mode," not in done.err and "--region" not in done.err


def test_one_point_is_not_several(shell):
    done = shell("sweep", "x.toml", "--over", "k=18", "--workers", "1")
    assert "V/F: poles at 1 point\n" in done.out or "X/F: poles at 1 point\n" in done.out
    assert "  k = 18 N/m, 1 value\n" in done.out


def test_a_sweep_of_poles_says_at_how_many_points_one_grows(shell):
    # s^2 + b s + 4 has its roots in the right half-plane for b < 0.
    text = 'symflex = 1\nparameters.b = { assume = "real" }\ninputs.u = {}\noutputs.y = "u/(s^2 + b*s + 4)"'
    (shell.folder / "grows.toml").write_text(text)
    command = ("sweep", "grows.toml", "--workers", "1", "--over")
    assert "  stable at 1 of 3 points, unstable at 2\n" in shell(*command, "b=-1,-0.5,1").out
    assert shell(*command, "b=-1,-0.5,1", "--json").json["unstable_points"] == 2
    assert "  stable at 2 of 2 points\n" in shell(*command, "b=1,2").out
    assert "  marginal at 1 of 1 point\n" in shell(*command, "b=0").out
