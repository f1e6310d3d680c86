#!/usr/bin/python3
"""tools/fit as a user meets it: what it finds, what it refuses, and that it goes on where it was stopped.
usage: fit_test.py TECTUM ROOT
"""
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

TECTUM, ROOT = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2]).resolve()
FIT = ROOT / "tools" / "fit" / "fit"

# One LIF neuron for each side, which drive an eye's pan against each other: the eye turns by `gain` for each degree of
# difference that the bias makes. A second of it is simulated in no time.
CIRCUIT = """{
  "tectum": 1, "name": "pair", "tick": "1 ms",
  "parameters": {
    "gain": { "value": "0.05 deg/Hz", "basis": "fitted" }, "bias": { "value": "4 nA", "about": "one neuron's drive" },
    "pause": "10 ms", "twice": "bias * 2"
  },
  "axes": { "horizontal": ["left", "right"] },
  "neurons": { "n": { "model": "lif_exp", "t_ref": "2 ms" } },
  "populations": {
    "MN": { "neuron": "n", "size": 4, "axis": "horizontal", "exceptions": { "right": { "I_bias": "bias" }, "left": { "t_ref": "pause" } } }
  },
  "outputs": {
    "pan": { "rate_difference": ["MN.right", "MN.left"], "window": "100 ms", "gain": "gain",
             "joints": ["left_eye_pan", "right_eye_pan"], "limits": ["-30 deg", "30 deg"] }
  }
}"""
PROTOCOL = {"tectum_protocol": 1, "name": "tiny", "target": {"kind": "step", "extent": "0.1 m", "step_hold": "0.5 s"},
            "wall_distance": "0.55 m", "frame_rate": "45 Hz", "trials": 2, "duration": "1 s", "first_seed": 0}
OBJECTIVE = {"tectum_objective": 1, "name": "near", "protocol": "tiny.json",
             "terms": [{"measures": "*/circuit/rmse_deg", "minimise": True, "scale": 10}]}


class Fit(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "pair.json").write_text(CIRCUIT)
        (self.folder / "tiny.json").write_text(json.dumps(PROTOCOL))
        (self.folder / "near.json").write_text(json.dumps(OBJECTIVE))

    def command(self, *arguments):
        return [str(FIT), "pair.json", "--objective", "./near.json", "--seeds", "500", "--tectum", TECTUM, "-o", "out.json",
                *arguments]

    def fit(self, *arguments):
        return subprocess.run(self.command(*arguments), cwd=self.folder, capture_output=True, text=True)

    def refused(self, *arguments):
        done = self.fit(*arguments)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertFalse((self.folder / "out.json").exists())
        return done.stderr

    def log(self):
        return (self.folder / "out.json.evaluations.jsonl").read_text().splitlines()

    SMALL = ("-p", "gain=0..0.1deg/Hz,bias=3..6nA", "--population", "5", "--generations", "1")

    def test_finds_better_values_and_goes_on_where_it_was(self):
        done = self.fit(*self.SMALL)
        self.assertEqual(done.returncode, 0, done.stderr)
        overlay = json.loads((self.folder / "out.json").read_text())
        self.assertEqual(overlay["extends"], "pair.json")
        self.assertEqual(set(overlay["parameters"]), {"gain", "bias"})
        self.assertEqual({p["basis"] for p in overlay["parameters"].values()}, {"fitted"})
        whole = self.log()
        self.assertGreater(len(whole), 5)

        # What it reports is what the overlay does, and the circuit itself is worse.
        costs = {}
        for name in ("pair", "out"):
            said = subprocess.run([TECTUM, "eval", f"{name}.json", "--protocol", "tuning_tiny.json", "--format", "json"],
                                  cwd=self.folder, capture_output=True, text=True)
            self.assertEqual(said.returncode, 0, said.stderr)
            costs[name] = json.loads(said.stdout)["settings"][0]["circuit"]["rmse_deg"] / 10
        self.assertLess(costs["out"], costs["pair"])
        self.assertIn(f"{costs['out']:.4g} with gain", done.stdout)
        self.assertIn(f"{costs['pair']:.4g} with the circuit's own", done.stdout)

        # Cut short, as by a crash: the same command runs what is missing and comes to the same end.
        log = self.folder / "out.json.evaluations.jsonl"
        log.write_text("\n".join(whole[:3]) + "\n" + whole[3][:40])
        again = self.fit(*self.SMALL)
        self.assertIn(f" {len(whole) - 3} run now", again.stdout)
        self.assertEqual(json.loads((self.folder / "out.json").read_text())["parameters"], overlay["parameters"])

        # Other weights need no evaluation; another circuit does.
        weighted = dict(OBJECTIVE, terms=[dict(OBJECTIVE["terms"][0], weight=2)])
        (self.folder / "near.json").write_text(json.dumps(weighted))
        self.assertIn(" 0 run now", self.fit(*self.SMALL).stdout)
        (self.folder / "pair.json").write_text(CIRCUIT.replace('"size": 4', '"size": 5'))
        self.assertNotIn(" 0 run now", self.fit(*self.SMALL[:2], "--population", "5", "--generations", "0").stdout)

    def test_interrupted_it_leaves_the_best_so_far(self):
        process = subprocess.Popen(self.command("-p", "gain=0..0.1deg/Hz", "--generations", "1000"), cwd=self.folder, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True)
        log = self.folder / "out.json.evaluations.jsonl"
        while process.poll() is None and not (log.exists() and len(self.log()) >= 4):
            time.sleep(0.01)
        os.killpg(process.pid, signal.SIGINT)  # as the terminal does: to the program that it runs as well
        out, err = process.communicate()
        self.assertEqual(process.returncode, 130, err)
        self.assertIn("stopped after", out)
        self.assertNotIn("Traceback", err)
        self.assertEqual(json.loads((self.folder / "out.json").read_text())["extends"], "pair.json")

    def test_dry_run_says_what_would_be_run(self):
        done = self.fit(*self.SMALL, "--dry-run")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("gain from 0.05 deg/Hz, between 0 and 0.1 deg/Hz", done.stdout)
        self.assertIn("10 evaluations at most", done.stdout)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["near.json", "pair.json", "tiny.json"])

    def test_an_objective_can_make_the_protocol_shorter(self):
        (self.folder / "near.json").write_text(json.dumps(dict(OBJECTIVE, change={"duration": "0.5 s"})))
        self.assertIn('on protocol tiny.json, duration "0.5 s"', self.fit(*self.SMALL, "--dry-run").stdout)
        self.assertEqual(self.fit("--measures").returncode, 0)
        protocol = json.loads((self.folder / "tuning_tiny.json").read_text())
        self.assertEqual((protocol["duration"], protocol["first_seed"], protocol["trials"]), ("0.5 s", 500, 1))
        for change, says in [({"durations": 1}, "has no `durations` that could be changed; did you mean `duration`?"),
                             ({"trials": 9}, "`trials` of the protocol is what --seeds says")]:
            (self.folder / "near.json").write_text(json.dumps(dict(OBJECTIVE, change=change)))
            self.assertIn(says, self.fit(*self.SMALL).stderr)

    def test_measures_are_listed_with_what_the_terms_make_of_them(self):
        done = self.fit("--measures")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"1 frame/circuit/rmse_deg +\d")
        self.assertIn("objective near:", done.stdout)

    def test_seeds_that_are_reported_on_are_refused(self):
        message = self.refused(*self.SMALL, "--seeds", "1..4")
        self.assertIn("protocol `tiny` reports on seeds 0..1, and 1 is among the seeds to tune on (1..4)", message)

    def test_what_makes_no_sense_is_refused(self):
        for parameters, says in [
            ("gian=0..1deg/Hz", "the circuit has no parameter `gian`; did you mean `gain`?"),
            ("gain=0.06..1deg/Hz", "`gain` is 0.05 deg/Hz in the circuit, outside its bounds 0.06..1deg/Hz"),
            ("gain=0..1deg", "`gain` is 0.05 deg/Hz in the circuit, and its bounds are in deg: write them in deg/Hz"),
            ("gain=0..1", "its bounds are plain numbers: write them in deg/Hz"),
            ("gain=1..0deg/Hz", "the lower comes first"),
            ("gain", "`gain` has no bounds"),
            ("twice=1..2nA", "`twice` is an expression in the circuit (`bias * 2`)"),
            ("gain=0..1deg/Hz,gain=0..1deg/Hz", "`gain` is given twice"),
            ("pause=5..20ms", "`pause` takes certain values only"),
            ("pause=-10..10ms:21", "the circuit does not take pause=-10 ms"),
        ]:
            with self.subTest(parameters):
                self.assertIn(says, self.refused("-p", parameters))
        self.assertIn("nothing to fit", self.refused())
        self.assertIn("no/tectum is missing: run tools/build", self.refused(*self.SMALL, "--tectum", "no/tectum"))
        self.assertIn("there is no objective called `sacades`; did you mean `saccades`?",
                      self.refused(*self.SMALL, "--objective", "sacades"))

    def test_a_mistake_in_an_objective_is_named(self):
        for terms, says in [
            ([{"measures": "*/circuit/rmse_deg", "minimize": True, "scale": 1}], "unknown key `minimize`; did you mean `minimise`?"),
            ([{"measures": "*/circuit/rmse_deg", "minimise": True}], "`scale` says how far off counts as 1"),
            ([{"measures": "*/circuit/rmse_deg", "scale": 1}], "one of `target`, `below` and `above`, or `minimise`"),
            ([{"measures": "*/circuit/rmsedeg", "minimise": True, "scale": 1}], "nothing is measured that `*/circuit/rmsedeg` matches"),
        ]:
            with self.subTest(says):
                (self.folder / "near.json").write_text(json.dumps(dict(OBJECTIVE, terms=terms)))
                self.assertIn(says, self.fit(*self.SMALL).stderr)

    def test_a_circuit_with_mistakes_is_reported_by_the_compiler(self):
        (self.folder / "pair.json").write_text(CIRCUIT.replace('"lif_exp"', '"lif_ex"'))
        done = self.fit(*self.SMALL)
        self.assertEqual(done.returncode, 1)
        self.assertIn("unknown neuron model `lif_ex`", done.stderr)


class ShippedObjectives(unittest.TestCase):
    def test_every_shipped_objective_can_be_planned(self):
        names = sorted(path.stem for path in (FIT.parent / "objectives").glob("*.json"))
        self.assertIn("saccades", names)
        wanted = [option for name in names for option in ("--objective", name)]
        done = subprocess.run([str(FIT), str(ROOT / "circuits" / "oculomotor.json"), "-p", "out_gain_v=0.5..2", "--tectum", TECTUM,
                               "--dry-run", *wanted], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in names:
            self.assertIn(f"objective  {name}, on protocol {name}", done.stdout)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
