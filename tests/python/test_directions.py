"""Which directions to measure, and which next: the program's, within what a device can do."""

import os
import pathlib
import pickle
import signal
import subprocess
import sys

import numpy as np
import pytest

import trilobe

from models import SMALL, isotropic

pytest.importorskip("trilobe._fit")

PROGRAM = pathlib.Path(os.environ.get("TRILOBE_PROGRAM", "build/release/bin/trilobe")).resolve()
needs_program = pytest.mark.skipif(not PROGRAM.exists(), reason=f"{PROGRAM} is not built")


def measured_at(at):
    return trilobe.Measurement(at.wi, at.wo, isotropic(12).eval(at.wi, at.wo))


@pytest.fixture(scope="module")
def measured():
    """Samples at the first directions of the plan."""
    return measured_at(trilobe.directions_to_measure(40))


@pytest.fixture(scope="module")
def found(measured):
    return trilobe.next_directions(measured, 8, progress=False)


def of_program(*arguments):
    """The rows of the program's CSV."""
    run = subprocess.run([PROGRAM, "measure", *map(str, arguments)], check=True, capture_output=True, text=True)
    return np.genfromtxt(run.stdout.splitlines(), delimiter=",", skip_header=2)


def same(angles, rows):
    """Whether angles are those of the program's CSV, in all of its digits."""
    np.testing.assert_array_equal([[float(f"{angle:.6g}") for angle in row] for row in angles], rows)


@needs_program
@pytest.mark.parametrize(("device", "flags"), [
    ({}, []),
    ({"in_plane": True, "theta_max": 70, "blind": 8}, ["--in_plane", "--theta_max=70", "--blind=8"]),
    ({"incidences": [10, 30, 50.5], "step": 2.5}, ["--incidences=10,30,50.5", "--step=2.5"]),
])
def test_plan_is_the_programs(device, flags):
    same(trilobe.directions_to_measure(60, **device).angles, of_program("--directions=60", *flags))


@needs_program
def test_next_are_the_programs(measured, tmp_path):
    path = tmp_path / "measured.csv"
    measured.save(path)
    found = trilobe.next_directions(path, 6, by="both", step=2, progress=False)
    same(found.directions.angles, of_program(path, "--next=6", "--by=both", "--step=2"))


def test_first_ones_of_more_are_those_of_fewer():
    plan = trilobe.directions_to_measure(200)
    assert len(plan) == 200 and plan.angles.shape == (200, 4)
    np.testing.assert_array_equal(plan[:50].angles, trilobe.directions_to_measure().angles)
    angles = plan.angles.round(4)
    exchanged = np.sort(angles[:, [0, 2]], axis=1)
    assert len(np.unique(np.column_stack([exchanged, angles[:, 3]]), axis=0)) == 200
    assert (plan.angles[:, 1] == 0).all() and (plan.angles[:, [0, 2]] <= 80).all() and (plan.angles >= 0).all()


def test_keeps_to_the_device():
    at = trilobe.directions_to_measure(40, theta_max=60, step=5, blind=10)
    np.testing.assert_allclose(at.angles / 5, (at.angles / 5).round(), atol=1e-9)
    assert at.angles[:, [0, 2]].max() <= 60 + 1e-9
    assert np.degrees(np.arccos((at.wi * at.wo).sum(axis=1))).min() >= 10 - 1e-6
    plane = trilobe.directions_to_measure(40, in_plane=True, incidences=(20, 45))
    assert set(plane.angles[:, 0].round(9)) == {20, 45} and set(plane.angles[:, 3].round(9)) == {0, 180}
    one = trilobe.directions_to_measure(5, incidences=np.float32(40))
    np.testing.assert_allclose(one.angles[:, 0], 40)


def test_directions_are_vectors_and_angles():
    at = trilobe.directions_to_measure(30)
    for w, theta, phi in ((at.wi, 0, 1), (at.wo, 2, 3)):
        np.testing.assert_allclose(np.linalg.norm(w, axis=1), 1)
        np.testing.assert_allclose(np.degrees(np.arccos(w[:, 2])), at.angles[:, theta])
        np.testing.assert_allclose(np.degrees(np.arctan2(w[:, 1], w[:, 0])), at.angles[:, phi], atol=1e-9)
    mine = trilobe.Directions([[10, 0, 20, 180], [30, 0, 40, 90], [50, 0, 60, 0]])
    np.testing.assert_array_equal(mine[mine.angles[:, 0] > 20].angles, mine[1:].angles)
    assert [len(one) for one in mine] == [1, 1, 1] and repr(mine[:2]) == "<trilobe.Directions: 2 pairs>"
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(mine)).angles, mine.angles)
    with pytest.raises(ValueError, match="read-only"):
        mine.angles[0, 0] = 1


def test_next_are_those_of_the_plan_that_are_left(measured, found):
    np.testing.assert_array_equal(found.directions.angles, trilobe.directions_to_measure(48).angles[40:])
    assert found.measured == 40
    assert 0 < found.expected_delta_e < found.delta_e
    assert found.expected_delta_e / found.delta_e == pytest.approx((40 / 48) ** 0.25)
    guess = trilobe.fit(measured, progress=False).report["verdict"]["whole"]
    assert found.delta_e == pytest.approx(guess["mean_delta_e"])


def test_chooses_by_design_none_twice():
    at = trilobe.directions_to_measure(20)
    found = trilobe.next_directions(measured_at(at), 5, by="design", threads=1, progress=False)
    assert (found.measured, found.delta_e, found.expected_delta_e) == (20, None, None)
    both = np.concatenate([at.angles, found.directions.angles])
    assert len(np.unique(both.round(2), axis=0)) == 25


BAD = [
    (lambda m: trilobe.directions_to_measure(0), "range", "directions", "give 1 to 100000"),
    (lambda m: trilobe.directions_to_measure(2.5), "format", "directions", "must be an integer"),
    (lambda m: trilobe.directions_to_measure(5000, step=30), "range", "directions", "reaches 24 of 5000"),
    (lambda m: trilobe.directions_to_measure(theta_max=90), "range", "theta_max", "below 90"),
    (lambda m: trilobe.directions_to_measure(theta_max=np.nan), "range", "theta_max", "below 90"),
    (lambda m: trilobe.directions_to_measure(incidences=[85]), "range", "incidences", "to theta_max, 80"),
    (lambda m: trilobe.directions_to_measure(incidences="10,20"), "format", "incidences", "dtype"),
    (lambda m: trilobe.directions_to_measure(step=-1), "range", "step", "to 45"),
    (lambda m: trilobe.directions_to_measure(blind="x"), "format", "blind", "must be a number of degrees"),
    (lambda m: trilobe.directions_to_measure(in_plane=3), "format", "in_plane", "True or False"),
    (lambda m: trilobe.Directions([[1, 2, 3]]), "mismatch", "angles", r"\(1, 3\), and must have \(n, 4\)"),
    (lambda m: trilobe.Directions([[1, 2, 3, np.inf]]), "data", "angles", "must be finite"),
    (lambda m: trilobe.next_directions(m, 0), "range", "next", "next=0; give 1 to 1000"),
    (lambda m: trilobe.next_directions(m, by="chance"), "unknown", "by", 'by="chance"; give plan, design or both'),
    (lambda m: trilobe.next_directions(m, 200, step=20), "range", "next", "ask for fewer"),
    (lambda m: trilobe.next_directions(m, threads=-1), "range", "threads", "negative"),
    (lambda m: trilobe.next_directions(SMALL), "unsupported", "next", "for scattered samples"),
    (lambda m: trilobe.next_directions("synth:linen@4x12"), "unsupported", "next", "for isotropic materials"),
    (lambda m: trilobe.next_directions(measured_at(trilobe.directions_to_measure(9))), "data", "next",
     r"at least 10 samples, and there are 9; begin with trilobe.directions_to_measure\(20\)"),
    (lambda m: trilobe.plot.directions([[1, 2, 3, 4]]), "format", "next", "must be trilobe.Directions"),
    (lambda m: trilobe.plot.directions(m, m.wi), "format", "measured", "must be trilobe.Directions"),
]


@pytest.mark.parametrize(("ask", "kind", "key", "told"), BAD)
def test_says_in_a_line_what_is_wrong(ask, kind, key, told, measured):
    with pytest.raises(trilobe.Error, match=told) as caught:
        ask(measured)
    assert (caught.value.kind, caught.value.key) == (kind, key)
    assert "\n" not in str(caught.value)


LONG = """
import signal
import trilobe
signal.signal(signal.SIGINT, signal.default_int_handler)  # whatever a script in the background passes on
at = trilobe.directions_to_measure(3000)
measured = trilobe.Measurement(at.wi, at.wo, trilobe.load("material:satin_purple").eval(at.wi, at.wo))
try:
    trilobe.next_directions(measured, 500, by="design", progress=True)
except KeyboardInterrupt:
    print("ended", flush=True)
"""


def test_ctrl_c_ends_it():
    pytest.importorskip("tqdm")
    environment = {key: value for key, value in os.environ.items() if key != "TQDM_DISABLE"}
    process = subprocess.Popen([sys.executable, "-c", LONG], stdout=subprocess.PIPE, text=True,
                               stderr=subprocess.PIPE, env=environment)
    told = ""
    while "1it" not in told:
        more = process.stderr.read(1)
        assert more, told
        told += more
    process.send_signal(signal.SIGINT)
    out, more = process.communicate(timeout=60)
    assert (process.returncode, out) == (0, "ended\n"), told + more


def test_draws_them(measured, found):
    pytest.importorskip("matplotlib").use("agg")
    for count, before in ((8, measured), (8, found.directions), (8, None), (200, None)):
        at = trilobe.directions_to_measure(count)
        figure = trilobe.plot.directions(at, before)
        figure.canvas.draw()
        above, beside = figure.axes[:2]
        numbers = [text.get_text() for text in above.texts if text.get_text().isdigit()]
        assert numbers == ([str(k + 1) for k in range(8)] if count == 8 else [])
        labels = [text.get_text() for text in above.get_legend().get_texts()]
        assert labels == ["measured"] * (before is not None) + ["next, in order" if count == 8 else "next"]
        last = [c for c in beside.collections if len(c.get_offsets()) == count][-1]
        wi, wo = at.wi, at.wo
        half = (wi + wo) / np.linalg.norm(wi + wo, axis=1, keepdims=True)
        expected = np.degrees([np.arccos((wi * half).sum(axis=1)), np.arccos(half[:, 2])]).T
        np.testing.assert_allclose(last.get_offsets(), expected, atol=1e-5)
