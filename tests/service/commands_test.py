"""What somebody at a terminal meets: runs that end early, faults that say where, names that are nearly right, files that
are not there, Ctrl-C, pictures and films, completion."""
import json
import os
import pathlib
import shutil
import signal
import stat
import struct
import subprocess
import tempfile
import time
import unittest

from cases import OSCILLATOR
from harness import BINARY
from patience import patience

FALLING = {"time": {"dt": 0.01, "duration": 1}, "systems": [
    {"type": "particles", "id": "p", "positions": [[0, 1, 0], [1, 2, 0]], "radius": 0.1}]}
FFMPEG = """#!/bin/sh
echo "$@" > "$(dirname "$0")/arguments"
for last; do :; done
exec cat > "$last"
"""


class Commands(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_truestep(self, *arguments, scene=None, text=None, environment=None):
        text = json.dumps(scene) if scene is not None else text
        return subprocess.run([BINARY, *map(str, arguments)], input=text, capture_output=True, text=True, cwd=self.folder,
                              timeout=patience(120), env=environment)

    def says(self, code, words, *arguments, **more):
        done = self.run_truestep(*arguments, **more)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        for part in [words] if isinstance(words, str) else words:
            self.assertIn(part, done.stdout + done.stderr)
        return done

    # --- expectations
    def test_a_run_that_ends_early_is_not_judged(self):
        scene = {**OSCILLATOR, "expect": [{"quantity": "energy.total", "min": 1e9, "source": "a control"}]}
        done = self.says(0, "not judged: ended before the duration", "run", "-", "--seconds", "0.5", scene=scene)
        self.assertNotIn("MISSED", done.stdout)
        expect = json.loads(self.run_truestep("run", "-", "--seconds", "0.5", "--json", scene=scene).stdout)["expect"][0]
        self.assertEqual((expect["met"], expect["not_judged"]), (None, "ended before the duration"))
        whole = self.says(6, "MISSED", "run", "-", scene=scene)
        self.assertNotIn("not judged", whole.stdout)

    # --- faults
    def test_faults_of_json_have_line_and_column(self):
        self.says(3, "line 3, column 7", "run", "-", text='{\n "a": 1,\n "b": }\n')
        # Columns are characters, not bytes.
        self.says(3, "line 1, column 9", "validate", "-", text='{"ä€𝄞": }')

    def test_what_other_notations_allow_is_named(self):
        for text, words in (('{"a": 1,}', "a comma before }"), ('{"a": [1, 2,]}', "a comma before ]"), ('{"a": NaN}', "NaN is no JSON number"),
                            ('{"a": -inf}', "infinity is no JSON number"), ("{'a': 1}", "double quotes"), ('{a: 1}', 'in double quotes: "a"'),
                            ('{"a": 1 // one\n}', "no comments"), ('{"a": 1, # one\n}', "no comments"), ('{"a": True}', "JSON writes true"),
                            ('{"a": .5}', "a digit before its point"), ('{"a": +1}', "no plus sign")):
            self.says(3, [words, "line 1, column"], "validate", "-", text=text)
        self.says(3, "neither true", "validate", "-", text='{"a": tru}')  # control: nobody's notation

    def test_times_with_units(self):
        for word, seconds in (("0.5", 0.5), ("250ms", 0.25), ("0.5s", 0.5), ("0.01m", 0.6)):
            done = self.run_truestep("run", "-", "--seconds", word, "--json", scene=FALLING)
            self.assertAlmostEqual(json.loads(done.stdout)["time"], seconds, msg=word)
        self.says(2, ["5x is no time", "5m"], "run", "-", "--seconds", "5x", scene=FALLING)
        self.says(2, ["not in range"], "run", "-", "--seconds", "-1s", scene=FALLING)

    def test_a_picture_is_a_png(self):
        self.says(2, ["p.jpg", ".png"], "run", "-", "--picture", "p.jpg", scene=FALLING)
        self.assertFalse((self.folder / "p.jpg").exists())

    def test_a_picture_of_an_unstable_run_says_its_time(self):
        stiff = {"time": {"dt": 0.05, "duration": 10}, "systems": [
            {"type": "mass_spring", "id": "m", "rope": {"from": [0, 0, 0], "to": [1, 0, 0], "links": 5}, "mass": 0.001,
             "stiffness": 1e6, "pinned": ["first"], "integrator": "euler"}]}
        self.says(4, ["unstable", "the last picture shows t = "], "render", "-", "-o", "p.png", "--at", "9", scene=stiff)
        self.assertTrue((self.folder / "p.png").exists())
        self.says(0, [], "render", "-", "-o", "q.png", "--at", "0.5", scene=FALLING)  # control: nothing to say

    def test_without_a_command_there_are_examples(self):
        done = self.run_truestep()
        self.assertEqual(done.returncode, 0)
        examples = [line.split("  ")[1] for line in done.stdout.splitlines() if line.startswith("  truestep ")]
        self.assertEqual(len(examples), 3)
        self.assertEqual(self.run_truestep(*examples[0].split()[1:]).returncode, 0, examples[0])

    def test_systems_answers_for_couplings_documents_and_commands(self):
        for word in ("contact", "scene", "viewer", "push", "commands", "couplings"):
            done = self.run_truestep("systems", word)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertGreater(len(done.stdout.splitlines()), 4, word)
        rigid, whole = (self.run_truestep("systems", "rigid3d", *more).stdout.splitlines() for more in ((), ("--all",)))
        self.assertLess(len(rigid), 120, "two screens of sixty lines")
        self.assertGreater(len(whole), 4 * len(rigid))
        self.assertIn("did you mean", self.run_truestep("systems", "cloth").stderr)
        self.assertIn("did you mean --seconds?", self.run_truestep("run", "robertson", "--second", "3").stderr)
        refused = self.run_truestep("validate", "-", scene={"systems": [{"type": "particles", "id": "p", "positions": [[0, 0, 0]],
                                                                          "integrator": "runge_kutta4"}]})
        self.assertIn('did you mean "rk4"?', refused.stderr + refused.stdout)

    def test_every_system_and_coupling_has_a_scene_that_runs(self):
        listed = self.run_truestep("systems").stdout.split("\ncommands\n")[0].splitlines()
        types = [line.split("\t")[0] for line in listed if "\t" in line]
        types = [name for name in types if name not in ("scene", "viewer")]
        self.assertEqual(len(types), 31)
        for name in types:
            scene = self.run_truestep("systems", name, "--example")
            self.assertEqual(scene.returncode, 0, name)
            self.assertIn(f'"type": "{name}"', scene.stdout)
            done = self.run_truestep("run", "-", "--steps", "10", "--progress", "none", text=scene.stdout)
            self.assertEqual((done.returncode, done.stderr), (0, ""), name)

    def test_all_faults_of_a_scene_at_once(self):
        scene = {"gravty": 1, "accuracy": {"tolerance": 1e-3, "system": "b"},
                 "systems": [{"type": "oscillator", "id": "a", "mass": -1, "stifness": 2, "integrator": "eulr"},
                             {"type": "mass_spring", "id": "b", "rope": {"from": [0, 1, 0], "to": [1, 1, 0], "links": 0, "lincs": 3}},
                             {"type": "rigid3d", "id": "c", "bodies": [{"type": "sphere", "radius": -1}, {"type": "bx"}],
                              "joints": [{"type": "revolut", "a": "x"}]}],
                 "couplings": [{"type": "contakt", "a": "a", "b": "zz"}],
                 "probes": [{"id": "p", "system": "none", "fields": ["position"]}],
                 "expect": [{"quantity": "nothing", "max": 1, "source": "x"}]}
        faults = json.loads(self.run_truestep("validate", "-", "--json", scene=scene).stdout)["errors"]
        self.assertLessEqual({"/gravty", "/systems/0/mass", "/systems/0/stifness", "/systems/0/integrator", "/systems/1/rope/links",
                              "/systems/1/rope/lincs", "/systems/2/bodies/0/radius", "/systems/2/bodies/1/type",
                              "/systems/2/joints/0/type", "/couplings/0/type", "/probes/0/system", "/expect/0/quantity"},
                             {f["pointer"] for f in faults})
        self.assertFalse([f for f in faults if f.get("allowed", "").startswith(",")])
        # What is sound is not told: the control.
        self.assertFalse({"/systems/0/id", "/accuracy/system", "/systems/1/rope/from"} & {f["pointer"] for f in faults})

    def test_nearly_right_names(self):
        for words, arguments in (('did you mean "hanging_cloth"?', ("run", "hangin_cloth")),
                                 ('did you mean "hanging_cloth"?', ("validate", "hanging_clot")),
                                 ('did you mean "hanging_cloth"?', ("study", "stability", "hanging_cloht")),
                                 ('did you mean "dominoes"?', ("gallery", "dominos")),
                                 ('did you mean "rigid3d"?', ("systems", "rigd3d")),
                                 ('did you mean "validate"?', ("validat", "scene.json")),
                                 ('did you mean "run"?', ("rn",))):
            self.says(2, words, *arguments)
        self.assertNotIn("did you mean", self.says(2, "there is no command", "zzzzzz").stderr)
        for system in ({"type": "oscillator"}, {"type": "ode", "states": {"y": 1}, "equations": {"y": "-y"}}, {"type": "oscillator", "mass": -1}):
            self.says(3, 'did you mean "dopri5"?', "validate", "-", scene={"systems": [{**system, "integrator": "dopri"}]})

    def test_files_that_are_not_there(self):
        (self.folder / "scene.json").write_text(json.dumps(FALLING))
        for arguments in (("run", "no.json"), ("validate", "no.json"), ("info", "no.vtkhdf"), ("export", "no.vtkhdf", "-o", "x"),
                          ("diff", "no.vtkhdf", "no.vtkhdf"), ("replay", "no.bundle"), ("render", "no.vtkhdf", "-o", "x.png"),
                          ("run", "scene.json", "--from", "no.snapshot"), ("study", "stability", "no.json"), ("run", str(self.folder)),
                          ("info", str(self.folder))):
            self.assertEqual(self.run_truestep(*arguments).returncode, 2, arguments)
        # A file that is there and is something else: the control.
        self.assertEqual(self.run_truestep("info", "scene.json").returncode, 3)

    def test_a_method_without_a_stable_step_is_not_told_zero_seconds(self):
        scene = {"time": {"dt": 0.01}, "systems": [{"type": "oscillator", "stiffness": 100, "position": 1, "integrator": "euler"}]}
        done = self.says(0, "gains energy at every step", "validate", "-", scene=scene)
        self.assertNotIn("at most 0", done.stdout)
        scene["systems"][0] |= {"integrator": "rk4", "stiffness": 1e9}
        self.says(0, "at most", "validate", "-", scene=scene)

    # --- Ctrl-C
    def test_ctrl_c_completes_the_files(self):
        path = self.folder / "run.vtkhdf"
        process = subprocess.Popen([BINARY, "run", "-", "--seconds", "100000", "-o", path, "--csv", "out.csv", "--progress", "none"],
                                   stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=self.folder)
        self.addCleanup(process.kill)
        process.stdin.write(json.dumps({**FALLING, "time": {"dt": 0.001, "duration": 1e5}}))
        process.stdin.close()
        process.stdin = None
        until = time.monotonic() + patience(30)
        while time.monotonic() < until and not (path.exists() and path.stat().st_size > 1_000_000):
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=patience(30))
        self.assertEqual((process.returncode, "interrupted at step" in said), (130, True), said)
        info = json.loads(self.run_truestep("info", path, "--json").stdout)
        self.assertTrue(info["finalized"])
        self.assertGreater(info["frames"], 1)
        last = (self.folder / "out.csv").read_text().splitlines()[-1].split(",")
        self.assertEqual(int(last[0]), info["last_step"])

    def test_a_signal_ends_a_step_and_the_search_for_remedies(self):
        """A light, all but inextensible sheet in the wind: steps of many iterations, and after one that fails trials of as many."""
        scene = {"time": {"dt": 1, "duration": 1000}, "systems": [{
            "type": "mass_spring", "id": "cloth", "stiffness": 1e9, "shear_stiffness": 1e9, "integrator": "implicit_euler", "mass": 0.01,
            "cloth_grid": {"origin": [-0.5, 1, -0.5], "nx": 12, "ny": 12}, "pinned": ["corner_00", "corner_10"]}]}
        path = self.folder / "run.vtkhdf"
        process = subprocess.Popen([BINARY, "run", "-", "-o", path, "--progress", "none"],
                                   stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=self.folder)
        self.addCleanup(process.kill)
        process.stdin.write(json.dumps(scene))
        process.stdin.close()
        process.stdin = None
        until = time.monotonic() + patience(30)
        while time.monotonic() < until and not path.exists():
            time.sleep(0.02)
        time.sleep(1)
        process.send_signal(signal.SIGTERM)
        # It took minutes, whatever was sent.
        _, said = process.communicate(timeout=patience(10))
        self.assertIn(process.returncode, (4, 130), said)
        self.assertIn("interrupted at step", said)

    # --- pictures
    def size_of(self, path):
        data = pathlib.Path(path).read_bytes()
        self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n")
        return struct.unpack(">II", data[16:24])

    def render(self, *arguments, **more):
        done = self.run_truestep("render", *arguments, "--size", "160x90", "--progress", "none", **more)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_pictures_of_a_scene_and_of_its_recording_are_the_same(self):
        scene = json.loads(self.run_truestep("gallery", "newtons_cradle_3d").stdout)
        self.assertEqual(self.run_truestep("run", "-", "--seconds", "0.5", "-o", "r.vtkhdf", scene=scene | {"recording": {"precision": "f64"}}).returncode, 0)
        self.render("-", "-o", "a/scene.png", "--to", "0.5", "--fps", "4", scene=scene)
        self.render("r.vtkhdf", "-o", "b/file.png", "--fps", "4")
        names = [f"{k:06}" for k in range(3)]
        self.assertEqual(sorted(p.name for p in (self.folder / "a").iterdir()), [f"scene.{n}.png" for n in names])
        pictures = []
        for n in names:
            scene_picture, file_picture = self.folder / f"a/scene.{n}.png", self.folder / f"b/file.{n}.png"
            self.assertEqual(self.size_of(scene_picture), (160, 90))
            self.assertEqual(scene_picture.read_bytes(), file_picture.read_bytes(), n)
            pictures.append(scene_picture.read_bytes())
        self.assertEqual(len(set(pictures)), 3, "nothing moves")

    def test_recorded_curves_and_obstacles_are_drawn(self):
        for name in ("lotka_volterra", "moving_obstacle"):
            scene = json.loads(self.run_truestep("gallery", name).stdout) | {"recording": {"precision": "f64"}}
            self.assertEqual(self.run_truestep("run", "-", "--seconds", "0.6", "-o", "r.vtkhdf", scene=scene).returncode, 0)
            for source, path in (("-", "s.png"), ("r.vtkhdf", "f.png")):
                self.render(source, "-o", path, "--at", "0.6", scene=scene if source == "-" else None)
            self.assertEqual((self.folder / "s.png").read_bytes(), (self.folder / "f.png").read_bytes(), name)

    def test_size_camera_and_side(self):
        def picture(*arguments):
            self.render("-", "-o", "p.png", "--at", "0.2", *arguments, scene=FALLING)
            return (self.folder / "p.png").read_bytes()
        looks = [picture(), picture("--camera", "0,1,5,0,1,0"), picture("--view", "top"), picture("--view", "side")]
        self.assertEqual(len(set(looks)), 4)
        self.assertEqual(picture(), looks[0])
        done = self.run_truestep("run", "-", "--steps", "2", "--picture", "q.png", "--size", "64x48", "--camera", "0,1,5,0,1,0", scene=FALLING)
        self.assertEqual((done.returncode, self.size_of(self.folder / "q.png")), (0, (64, 48)))
        for wrong in (("--size", "64"), ("--size", "64x9999999"), ("--camera", "1,2,3"), ("--view", "left")):
            self.assertEqual(self.run_truestep("render", "-", "-o", "p.png", *wrong, scene=FALLING).returncode, 2, wrong)

    def test_a_film_needs_ffmpeg_and_says_so(self):
        bare = {**os.environ, "PATH": str(self.folder)}
        for name in ("film.mp4", "film.gif"):
            done = self.run_truestep("render", "-", "-o", name, scene=FALLING, environment=bare)
            self.assertEqual(done.returncode, 2)
            self.assertIn("ffmpeg, which is not installed", done.stderr)
        self.says(2, ".mp4 or .gif", "render", "-", "-o", "film.avi", scene=FALLING)

    def test_ffmpeg_gets_every_picture(self):
        program = self.folder / "bin" / "ffmpeg"
        program.parent.mkdir()
        program.write_text(FFMPEG)
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        path = {**os.environ, "PATH": f"{program.parent}:{os.environ['PATH']}"}
        self.assertIn("11 pictures", self.render("-", "-o", "out/film.mp4", "--fps", "10", scene=FALLING, environment=path))
        self.assertEqual((self.folder / "out/film.mp4").stat().st_size, 11 * 160 * 90 * 4)
        arguments = (program.parent / "arguments").read_text()
        for words in ("-video_size 160x90", "-framerate 10", "-pixel_format rgba"):
            self.assertIn(words, arguments)
        program.write_text("#!/bin/sh\nexit 1\n")
        self.assertNotEqual(self.run_truestep("render", "-", "-o", "film.gif", scene=FALLING, environment=path).returncode, 0)

    @unittest.skipIf(shutil.which("ffmpeg") is None, "ffmpeg is not installed")
    def test_a_film(self):
        for name, head in (("film.mp4", b"ftyp"), ("film.gif", b"GIF89a")):
            self.render("-", "-o", name, "--fps", "10", scene=FALLING)
            self.assertIn(head, (self.folder / name).read_bytes()[:16])

    # --- completion
    def test_completion(self):
        for shell in ("bash", "zsh", "fish"):
            self.assertIn("render", self.says(0, "truestep", "completion", shell).stdout)
        self.assertEqual(self.run_truestep("completion", "tcsh").returncode, 2)
        script = self.run_truestep("completion", "bash").stdout
        def complete(*words):
            line = " ".join(words)
            done = subprocess.run(["bash", "-c", f'{script}\nCOMP_WORDS=({line}) COMP_CWORD={len(words) - 1} COMPREPLY=()\n_truestep\necho "${{COMPREPLY[@]}}"'],
                                  capture_output=True, text=True, cwd=self.folder)
            self.assertEqual(done.stderr, "")
            return done.stdout.split()
        self.assertEqual(sorted(complete("truestep", "re")), ["render", "replay"])
        self.assertEqual(complete("truestep", "run", "hanging_cl"), ["hanging_cloth"])
        self.assertEqual(complete("truestep", "run", "x.json", "--pict"), ["--picture"])
        self.assertEqual(complete("truestep", "run", "nothing_of_the_kind"), [])


if __name__ == "__main__":
    unittest.main()
