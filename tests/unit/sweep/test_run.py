import multiprocessing
import os
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import Executor, Future

import numpy as np
import pytest

import symflex
from symflex.errors import BudgetError, UsageError
from symflex.sweep import chunk_size, read_design, run_sweep, sweep_key, sweep_task
from symflex.sweep.files import npz_bytes, open_journal
from symflex.sweep.run import IN_A_ROW, open_pool
from tests.house.repository import ROOT
from tests.unit.sweep.models import LOOP, SLIDING_FREE, oscillator


class Backwards(Executor):
    """Does nothing until asked for a result, and then the last call first."""

    def __init__(self):
        self.calls = []

    def submit(self, function, /, *args, **kwargs):
        future = Future()
        self.calls.append((future, function, args))
        if len(self.calls) >= 3:
            self.finish()
        return future

    def finish(self):
        for future, function, args in reversed(self.calls):
            future.set_result(function(*args))
        self.calls = []


def task_and_design(count):
    model = oscillator().resolved
    design = read_design(model.parameters, [f"k=1:100:log:{count}"])
    return sweep_task(model, ("X", "F"), design), design


@pytest.mark.slow
def test_the_order_in_which_chunks_come_back_does_not_matter():
    task, design = task_and_design(401)
    here, there = run_sweep(task, design), run_sweep(task, design, Backwards(), workers=3)
    assert npz_bytes(here) == npz_bytes(there)


def test_chunks_of_several_widths_are_joined():
    model = oscillator()
    sweep = model.sweep({"b": "0.1:4:lin:20"})
    assert sweep["status"].shape == (20, 2)
    assert np.sum(sweep["status"] > 0, axis=1).tolist() == [1 if b < 2 else 2 for b in sweep["b"]]


class Broken(Executor):
    def submit(self, function, /, *args, **kwargs):
        from concurrent.futures import BrokenExecutor

        future = Future()
        future.set_exception(BrokenExecutor("gone"))
        return future


def test_a_worker_that_dies_is_reported():
    task, design = task_and_design(3)
    with pytest.raises(BudgetError, match="SF508"):
        run_sweep(task, design, Broken())


class Shown:
    def __init__(self):
        self.said = []

    def report(self, done, text):
        self.said.append((done, text))


def test_progress_says_how_much_is_left():
    task, design = task_and_design(2)
    shown, clock = Shown(), iter([0.0, 10.0, 20.0])
    run_sweep(task, design, progress=shown, clock=lambda: next(clock))
    assert shown.said == [(0.5, "1 of 2 points, 10 s left"), (1.0, "2 of 2 points, 0 s left")]


def test_what_a_journal_holds_is_not_solved_again(tmp_path, monkeypatch):
    task, design = task_and_design(2)
    journal = open_journal(tmp_path / "a.nc", "key")
    expected = npz_bytes(run_sweep(task, design, journal=journal))
    assert journal.kept == 2

    def solve(*args):
        raise AssertionError(args)

    monkeypatch.setattr("symflex.sweep.run.solve_chunk", solve)
    again = open_journal(tmp_path / "a.nc", "key")
    assert npz_bytes(run_sweep(task, design, journal=again)) == expected


def test_a_chunk_that_cannot_be_read_is_solved_again(tmp_path):
    task, design = task_and_design(2)
    expected = npz_bytes(run_sweep(task, design, journal=open_journal(tmp_path / "a.nc", "key")))
    (tmp_path / "a.nc.part" / "chunk-000001.npz").write_bytes(b"PK\x03\x04 torn")
    (tmp_path / "a.nc.part" / ".symflex-0123.tmp").write_bytes(b"left by a kill")
    journal = open_journal(tmp_path / "a.nc", "key")
    assert npz_bytes(run_sweep(task, design, journal=journal)) == expected
    journal.remove()
    assert not (tmp_path / "a.nc.part").exists()


def test_the_journal_of_another_sweep_is_refused(tmp_path):
    open_journal(tmp_path / "a.nc", "one")
    with pytest.raises(UsageError, match="SF916") as caught:
        open_journal(tmp_path / "a.nc", "other")
    assert "--fresh" in caught.value.diagnostics[0].hint
    assert open_journal(tmp_path / "a.nc", "other", is_fresh=True).kept == 0


def test_a_folder_that_is_no_journal_is_left_alone(tmp_path):
    folder = tmp_path / "a.nc.part"
    folder.mkdir()
    (folder / "thesis.txt").write_text("mine")
    for is_fresh in (False, True):
        with pytest.raises(UsageError, match="SF916"):
            open_journal(tmp_path / "a.nc", "key", is_fresh=is_fresh)
    assert (folder / "thesis.txt").read_text() == "mine"


def test_keys_tell_sweeps_apart():
    task, design = task_and_design(5)
    other = read_design(task.model.parameters, ["k=1:100:lin:5"])
    zeros = sweep_task(task.model, ("X", "F"), design, "zeros")
    keys = [sweep_key(task, design, "1"), sweep_key(task, other, "1"), sweep_key(zeros, design, "1")]
    keys.append(sweep_key(task, design, "2"))
    assert len(set(keys)) == 4
    again, same = task_and_design(5)
    assert sweep_key(again, same, "1") == keys[0]


def test_a_response_is_what_the_formula_says():
    sweep = oscillator().sweep({"k": [4, 9], "m": [1]}, of="response", frequencies=[0.1, 1, 10])
    s = 2j * np.pi * np.array([0.1, 1, 10])
    for i, k in enumerate((4, 9)):
        expected = 1 / (s**2 + 0.5 * s + k)
        assert np.allclose(sweep["re"][i, 0] + 1j * sweep["im"][i, 0], expected, rtol=1e-14)


def test_margins_are_what_routh_says():
    sweep = symflex.loads(LOOP).sweep({"K": [1, 2, 7]}, of="margins", gain="K")
    # s^3 + 3 s^2 + 2 s + K is stable for 0 < K < 6.
    assert sweep["stable"].tolist() == [1, 1, 0]
    assert np.allclose(sweep["gain_margin_up"][:2], [6, 3], rtol=1e-15)
    assert np.isnan(sweep["gain_margin_up"][2])
    assert sweep["gain_margin_down"][:2].tolist() == [0, 0]
    w = 2 * np.pi * sweep["crossover"][0]
    loop = 1 / (1j * w * (1j * w + 1) * (1j * w + 2))
    assert abs(loop) == pytest.approx(1)
    assert sweep["phase_margin"][0] == pytest.approx(180 + np.degrees(np.angle(loop)))


# --------------------------------------------------------------------------- processes, kills and clusters

POINTS = 2000
ARGUMENTS = ["--over", "E=+-5%", "--over", "l=+-2%", "--monte-carlo", str(POINTS), "--modes", "6"]


def symflex_sweep(folder, output, *more):
    spec = folder / "beam.toml"
    spec.write_text(SLIDING_FREE)
    command = [sys.executable, "-m", "symflex", "sweep", str(spec), *ARGUMENTS, "-o", str(folder / output)]
    return [*command, *more], {**os.environ, "PYTHONPATH": str(ROOT)}


def run(folder, output, *more):
    command, environment = symflex_sweep(folder, output, *more)
    subprocess.run(command, env=environment, check=True, capture_output=True)
    return (folder / output).read_bytes()


@pytest.mark.slow
def test_a_sweep_that_is_killed_goes_on_to_the_same_bytes(tmp_path):
    expected = run(tmp_path, "one.nc", "--workers", "1")
    command, environment = symflex_sweep(tmp_path, "killed.nc", "--workers", "1")
    journal = tmp_path / "killed.nc.part"
    with subprocess.Popen(
        command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    ) as p:
        for _ in range(6000):
            if len(list(journal.glob("chunk-*.npz"))) >= 20 or p.poll() is not None:
                break
            time.sleep(0.01)
        p.send_signal(signal.SIGKILL)
    kept = {path.name: path.stat().st_mtime_ns for path in journal.glob("chunk-*.npz")}
    assert 0 < len(kept) < POINTS // chunk_size(POINTS, IN_A_ROW)
    assert not (tmp_path / "killed.nc").exists()
    assert run(tmp_path, "killed.nc", "--workers", "2") == expected
    assert not journal.exists()


def is_alive(process):
    # An orphan of a container without a reaper stays as a zombie, which is gone all the same.
    listed = subprocess.run(["ps", "-o", "stat=", "-p", str(process)], check=False, capture_output=True)
    return bool(listed.stdout.strip()) and not listed.stdout.strip().startswith(b"Z")


def descendants_of(process):
    """Return the processes below one: a command works in one of its own, which has the workers."""
    listed = subprocess.run(["ps", "-A", "-o", "pid=,ppid="], capture_output=True, text=True, check=True)
    pairs = [tuple(map(int, line.split())) for line in listed.stdout.splitlines()]
    found = [process]
    for parent in found:
        found += [child for child, of in pairs if of == parent]
    return found[1:]


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("ps") is None, reason="needs ps")
def test_the_workers_of_a_sweep_that_is_killed_end(tmp_path):
    command, environment = symflex_sweep(tmp_path, "killed.nc", "--workers", "2")
    journal = tmp_path / "killed.nc.part"
    with subprocess.Popen(
        command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    ) as p:
        for _ in range(6000):
            if len(list(journal.glob("chunk-*.npz"))) >= 4 or p.poll() is not None:
                break
            time.sleep(0.01)
        workers = descendants_of(p.pid)
        assert len(workers) >= 3
        p.send_signal(signal.SIGKILL)
    for _ in range(3000):
        if not any(map(is_alive, workers)):
            break
        time.sleep(0.01)
    left = [worker for worker in workers if is_alive(worker)]
    for worker in left:
        os.kill(worker, signal.SIGKILL)
    assert not left


@pytest.mark.slow
@pytest.mark.needs_module("distributed")
@pytest.mark.slow
def test_an_address_that_is_none_is_refused_and_leaves_nothing_to_close():
    # Finalizers complain when the interpreter ends, and not before.
    script = (
        "from symflex.errors import UsageError\n"
        "from symflex.sweep.run import open_executor\n"
        "for address in ('garbage', 'xyz://a:1'):\n"
        "    try:\n"
        "        with open_executor(scheduler=address):\n"
        "            pass\n"
        "    except UsageError as error:\n"
        "        print(error.diagnostics[0].code)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        check=True,
        capture_output=True,
        text=True,
    )
    assert (done.stdout.split(), done.stderr) == (["SF917", "SF917"], "")


@pytest.mark.slow
@pytest.mark.needs_module("distributed")
@pytest.mark.slow
def test_a_cluster_of_two_workers_gives_the_same_bytes(tmp_path):
    script = tmp_path / "cluster.py"
    script.write_text(
        "import subprocess, sys\n"
        "from distributed import LocalCluster\n"
        "if __name__ == '__main__':\n"
        "    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None,\n"
        "                      host='127.0.0.1', protocol='tcp') as cluster:\n"
        "        address = cluster.scheduler_address\n"
        "        assert address.startswith('tcp://127.0.0.1')\n"
        "        sys.exit(subprocess.run([*sys.argv[1:], '--scheduler', address]).returncode)\n"
    )
    command, environment = symflex_sweep(tmp_path, "cluster.nc")
    subprocess.run([sys.executable, str(script), *command], env=environment, check=True, capture_output=True)
    assert (tmp_path / "cluster.nc").read_bytes() == run(tmp_path, "one.nc", "--workers", "1")


def test_processes_end_at_once_where_an_exception_leaves_their_block():
    # They sleep for a minute; who leaves waits for none.
    begun, others = time.monotonic(), set(multiprocessing.active_children())
    with pytest.raises(KeyError), open_pool(2) as pool:
        for _ in range(4):
            pool.submit(time.sleep, 60)
        raise KeyError
    # One that was only being started may be listed later than the others.
    while (left := set(multiprocessing.active_children()) - others) and time.monotonic() - begun < 20:
        for worker in left:
            worker.join(0.1)
    assert not left
    assert time.monotonic() - begun < 30


@pytest.mark.slow
def test_processes_ignore_ctrl_c_which_is_for_who_started_them():
    with open_pool(1) as pool:
        assert pool.submit(signal.getsignal, signal.SIGINT).result() == signal.SIG_IGN
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())
