"""What the Python package promises, on small bakes: unittest."""

import os
import pathlib
import signal
import tempfile
import threading
import unittest

import numpy as np

import octalux


# Shells start background commands with SIGINT ignored, and then Python raises no KeyboardInterrupt.
signal.signal(signal.SIGINT, signal.default_int_handler)


class Packaged(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        cls.scene = octalux.Scene("builtin:cornell-glossy")
        cls.stats = octalux.bake(cls.scene, cls.path / "a.olx", grid=(2, 2, 2), radiance_size=32, noise=0.2, bounces=2)
        cls.field = octalux.open(cls.path / "a.olx")

    @classmethod
    def tearDownClass(cls):
        cls.field.close()
        cls.scene.close()
        cls.folder.cleanup()

    def rays(self, count=500):
        random = np.random.default_rng(7)
        info = self.field.info
        origins = random.uniform(info.scene.bounds_min, info.scene.bounds_max, (count, 3)) * 0.8 + 0.05
        directions = random.normal(size=(count, 3))
        return origins, directions / np.linalg.norm(directions, axis=1, keepdims=True)

    def refused(self, result, words, function, *arguments, **named):
        with self.assertRaises(octalux.Error) as caught:
            function(*arguments, **named)
        self.assertEqual(caught.exception.result, result)
        self.assertIn(words, str(caught.exception))


class Fields(Packaged):
    def test_a_field_says_what_it_holds(self):
        info = self.field.info
        self.assertEqual((info.probes.count, info.maps.size, info.bounces.count), (8, 32, 2))
        self.assertEqual(info.bytes.file, os.path.getsize(self.path / "a.olx"))
        self.assertEqual(info.bytes.file, self.stats.file_bytes)
        self.assertEqual(self.field.positions.shape, (8, 3))
        self.assertFalse(self.field.buried.any())
        self.assertEqual(self.field.origin, (0, 0, 0))
        self.field.verify()

    def test_a_ray_down_finds_the_floor(self):
        start = self.field.positions[0]
        hit = self.field.trace(start, (0, -1, 0))
        self.assertEqual(hit.shape, ())
        self.assertEqual(hit["status"], octalux.FOUND)
        np.testing.assert_allclose(hit["distance_metres"], start[1], rtol=2e-3)
        np.testing.assert_allclose(hit["position"], (start[0], 0, start[2]), atol=2e-3)
        np.testing.assert_allclose(hit["normal"], (0, 1, 0), atol=2e-5)  # blocks keep normals to about 1.5e-5
        self.assertTrue((hit["radiance"] > 0).all())
        self.assertEqual(self.field.trace(start, (0, -1, 0), t_max=float(start[1]) / 2)["status"], octalux.MISS)

    def test_many_rays_are_the_same_as_one_by_one(self):
        origins, directions = self.rays(200)
        together = self.field.trace(origins, directions)
        for i in range(200):
            alone = self.field.trace(origins[i], directions[i])
            for name in together.dtype.names:  # whatever lies between members does not count
                self.assertEqual(together[i][name].tobytes(), alone[name].tobytes(), name)

    def test_shapes_come_back_and_out_is_filled(self):
        origins, directions = self.rays(24)
        flat = self.field.trace(origins, directions)
        grid = self.field.trace(origins.reshape(4, 6, 3), directions.reshape(4, 6, 3))
        self.assertEqual(grid.shape, (4, 6))
        np.testing.assert_array_equal(grid.reshape(24)["distance_metres"], flat["distance_metres"])
        out = np.empty(24, octalux.HIT)
        self.assertIs(self.field.trace(origins, directions, out=out), out)
        np.testing.assert_array_equal(out["probe"], flat["probe"])
        fan = self.field.trace(origins[0], directions)
        self.assertEqual(fan.shape, (24,))
        # Strided arrays and arrays of doubles are accepted as well.
        apart = np.asfortranarray(np.column_stack([origins, directions]))
        np.testing.assert_array_equal(self.field.trace(apart[:, :3], apart[:, 3:])["texel"], flat["texel"])
        self.assertEqual(self.field.trace(np.empty((0, 3)), np.empty((0, 3))).shape, (0,))

    def test_tracers_agree(self):
        origins, directions = self.rays()
        hits = [self.field.trace(origins, directions, tracer=t) for t in ("texel", "two_level", "hiz")]
        for other in hits[1:]:
            for name in ("status", "distance_metres", "probe", "texel"):
                np.testing.assert_array_equal(hits[0][name], other[name])

    def test_light_on_the_floor_is_what_a_ray_finds_there(self):
        places = np.array([(x, 0.0, z) for x in (0.2, 0.4) for z in (0.4, 0.5)])
        light = self.field.irradiance(places, (0, 1, 0))
        self.assertEqual((light.shape, light.dtype), ((4, 3), np.float32))
        self.assertTrue((light > 0).all())
        np.testing.assert_array_equal(self.field.irradiance(places[1], (0, 1, 0), views=(0, 1, 0)), light[1])
        self.assertFalse(self.field.irradiance((np.nan, 0, 0), (0, 1, 0)).any())
        in_space = self.field.volume_irradiance(places, (0, 1, 0))
        self.assertEqual(in_space.shape, places.shape)
        np.testing.assert_array_equal(self.field.volume_irradiance(places[1], (0, 1, 0)), in_space[1])

    def test_a_mirror_on_the_floor_sees_the_ceiling(self):
        places = np.full((5, 3), (0.3, 1e-3, 0.45))
        view = np.array((0.2, 1.0, 0.1)) / np.linalg.norm((0.2, 1.0, 0.1))
        found = self.field.glossy(places, (0, 1, 0), view, 0.0, np.linspace(0, 0.9, 10).reshape(5, 2))
        self.assertEqual((found.radiance.shape, found.weight.shape), ((5, 3), (5,)))
        mirrored = self.field.trace(places[0], view * (-1, 1, -1))
        np.testing.assert_allclose(found.radiance[0], mirrored["radiance"], rtol=0.05)
        np.testing.assert_allclose(found.half_cosine, view[1], rtol=1e-3)
        below = self.field.glossy(places[0], (0, 1, 0), (0, -1, 0), 0.5, (0.5, 0.5))
        self.assertEqual((below.weight, tuple(below.radiance)), (0, (0, 0, 0)))

    def test_threads_share_a_field(self):
        origins, directions = self.rays()
        expected, found = self.field.trace(origins, directions), [None] * 4

        def work(i):
            found[i] = self.field.trace(origins, directions)

        threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for hits in found:
            np.testing.assert_array_equal(hits["radiance"], expected["radiance"])

    def test_wrong_arrays_are_refused_in_words(self):
        for words, arguments in (("origins: an array of shape (2,)", ((1, 2), (0, 1, 0))),
                                 ("directions: an array of shape ()", ((1, 2, 3), 4)),
                                 ("directions has a length of 2, not 1", ((1, 2, 3), (0, 2, 0))),
                                 ("directions[1] has a length of 0", ((1, 2, 3), [(0, 1, 0), (0, 0, 0)])),
                                 ("broadcast", (np.zeros((2, 3)), [(0, 1, 0)] * 3)),
                                 ("t_max is not a number", ((1, 2, 3), (0, 1, 0), np.nan))):
            with self.assertRaisesRegex(ValueError, words.replace("(", r"\(").replace(")", r"\)").replace("[", r"\[")):
                self.field.trace(*arguments)
        for out in (np.empty(2, octalux.HIT), np.empty(4, octalux.HIT)[::2], np.empty(1, np.float32)):
            with self.assertRaisesRegex(ValueError, "out: not a writeable"):
                self.field.trace((1, 2, 3), [(0, 1, 0)], out=out)
        with self.assertRaisesRegex(ValueError, "normals: an array of shape"):
            self.field.irradiance(np.zeros((2, 3)), [(0, 1, 0)] * 3)
        for roughness, random in ((1.5, (0, 0)), (np.nan, (0, 0)), (0.5, (0, 1))):
            with self.assertRaisesRegex(ValueError, "numbers that are not from 0 to 1"):
                self.field.glossy((0, 0, 0), (0, 1, 0), (0, 1, 0), roughness, random)

    def test_wrong_settings_are_refused_in_words(self):
        ray = ((1, 2, 3), (0, 1, 0))
        with self.assertRaisesRegex(TypeError, "no setting 'tracers'"):
            self.field.trace(*ray, tracers="hiz")
        with self.assertRaisesRegex(ValueError, "'fast' is not one of texel, two_level, hiz"):
            self.field.trace(*ray, tracer="fast")
        for number in (-1, 2**32, 1.5):
            with self.assertRaisesRegex(ValueError, "max_probes: .* is not a whole number"):
                self.field.trace(*ray, max_probes=number)
        self.refused(octalux.Result.ARGUMENT, "without the selector 'octree'", self.field.trace, *ray, select="octree")
        self.refused(octalux.Result.ARGUMENT, "probe light", self.field.trace, *ray, hits="stored")

    def test_files_that_are_no_fields_are_refused(self):
        self.refused(octalux.Result.FILE, "none.olx", octalux.open, self.path / "none.olx")
        (self.path / "text.olx").write_text("no field at all, but long enough for the header that a field begins with, which is 64 bytes")
        self.refused(octalux.Result.FORMAT, "wrong magic", octalux.open, self.path / "text.olx")
        damaged = bytearray((self.path / "a.olx").read_bytes())
        damaged[len(damaged) // 2] ^= 1
        (self.path / "damaged.olx").write_bytes(damaged)
        with octalux.open(self.path / "damaged.olx") as field:
            self.refused(octalux.Result.CHECKSUM, "damaged.olx", field.verify)
        with self.assertRaisesRegex(ValueError, "the field is closed"):
            field.trace((0, 0, 0), (0, 1, 0))
        field.close()


class Scenes(Packaged):
    def test_a_scene_says_what_it_holds(self):
        self.assertIn("builtin:cornell", octalux.builtin_scenes())
        self.assertGreater(self.scene.info.triangles, 10)
        self.assertEqual(self.scene.info.hash, self.field.info.scene.hash)
        self.assertEqual(len(self.scene.cameras), self.scene.info.cameras)
        self.assertEqual(self.scene.warnings, [])
        self.refused(octalux.Result.FILE, "nosuch.obj", octalux.Scene, "nosuch.obj")

    def test_placed_probes_can_be_baked(self):
        probes = octalux.place(self.scene, count=3, surfels=500, candidates=64, voxels=24)
        self.assertEqual((len(probes), probes.positions.shape, len(probes.origins)), (3, (3, 3), 3))
        self.assertGreater(probes.report.coverage, 0.5)
        probes.save(self.path / "probes.json")
        self.assertIn('"probes"', (self.path / "probes.json").read_text())
        for chosen in (probes, probes.positions):
            octalux.bake(self.scene, self.path / "placed.olx", probes=chosen, radiance_size=16, noise=0.5, samples=1, select="voronoi")
            with octalux.open(self.path / "placed.olx") as field:
                np.testing.assert_array_equal(field.positions, probes.positions)
                self.assertTrue(field.info.select_mask & 2)

    def test_probes_are_placed_where_nothing_says_where_they_are(self):
        corners = [(x, y, z) for x in (0, 4) for y in (0, 3) for z in (0, 5)]
        faces = ["2 4 3 1", "7 8 6 5", "5 6 2 1", "4 8 7 3", "3 7 5 1", "6 8 4 2"]  # seen from inside
        lines = ["v {} {} {}".format(*corner) for corner in corners] + [f"f {face}" for face in faces]
        (self.path / "room.obj").write_text("\n".join(lines) + "\n")
        (self.path / "flat.obj").write_text("\n".join(lines[:8:2] + ["f 1 2 4 3"]) + "\n")
        settings = dict(radiance_size=16, noise=0.5, samples=1)
        with octalux.Scene(self.path / "room.obj") as room:
            octalux.bake(room, self.path / "room.olx", **settings)
            with octalux.open(self.path / "room.olx") as field:
                np.testing.assert_array_equal(field.positions, octalux.place(room, resolution=16).positions)
            with self.assertRaisesRegex(ValueError, "in parts needs probes"):
                octalux.bake(room, self.path / "room.olx", work={"folder": str(self.path / "work"), "part": 1, "parts": 2}, **settings)
        with octalux.Scene(self.path / "flat.obj") as flat, self.assertWarnsRegex(UserWarning, "nowhere to place probes.*on a grid"):
            self.refused(octalux.Result.ARGUMENT, "4 probes at the same", octalux.bake, flat, self.path / "flat.olx", **settings)

    def test_a_budget_gives_the_size_of_maps(self):
        path, settings = self.path / "budget.olx", dict(grid=(2, 1, 2), noise=0.5, samples=1)
        stats = octalux.bake(self.scene, path, budget_mb=0.1, **settings)
        self.assertLessEqual(stats.file_bytes, 1.05 * 0.1e6)
        with octalux.open(path) as field:
            self.assertEqual(field.info.maps.size, 64)
        self.refused(octalux.Result.ARGUMENT, "budget of 0.001 MB does not hold a field of 4 probes", octalux.bake, self.scene, path,
                     budget_mb=0.001, **settings)
        with self.assertRaisesRegex(ValueError, "exclude each other"):
            octalux.bake(self.scene, path, budget_mb=1, radiance_size=64)

    def test_bakes_depend_on_settings_alone(self):
        settings = dict(grid=(2, 1, 2), radiance_size=16, noise=0.5, samples=1)
        for threads in (1, 3):
            octalux.bake(self.scene, self.path / f"{threads}.olx", threads=threads, **settings)
        self.assertEqual((self.path / "1.olx").read_bytes(), (self.path / "3.olx").read_bytes())

    def test_wrong_settings_are_refused_in_words(self):
        path = self.path / "never.olx"
        self.refused(octalux.Result.ARGUMENT, "radiance size of 100 texels", octalux.bake, self.scene, path, radiance_size=100)
        for words, settings in (("three counts", dict(grid=(2, 2))), ("three counts", dict(grid=(0, 2, 2))),
                                ("(count, 3)", dict(probes=np.zeros((0, 3)))), ("not one of", dict(select="tree")),
                                ("not one of", dict(light="sun"))):
            with self.assertRaisesRegex(ValueError, words.replace("(", r"\(").replace(")", r"\)")):
                octalux.bake(self.scene, path, **settings)
        self.refused(octalux.Result.FILE, "no/such", octalux.bake, self.scene, self.path / "no/such/a.olx", radiance_size=16)
        self.assertFalse(path.exists())
        with self.assertRaisesRegex(ValueError, "not one of grid, sdf"):
            octalux.place(self.scene, "best")

    def test_progress_ends_work(self):
        heard = []

        def stop(stage, done):
            heard.append((stage, done))
            return False

        path = self.path / "stopped.olx"
        self.refused(octalux.Result.CANCELLED, "cancelled", octalux.bake, self.scene, path, radiance_size=256, progress=stop)
        self.assertTrue(heard and 0 <= heard[0][1] <= 1)

        def fail(stage, done):
            raise RuntimeError("enough of " + stage)

        with self.assertRaisesRegex(RuntimeError, "enough of"):
            octalux.bake(self.scene, path, radiance_size=256, progress=fail)
        self.assertFalse(path.exists())

    def test_ctrl_c_ends_work(self):
        path, before = self.path / "interrupted.olx", signal.getsignal(signal.SIGINT)
        for progress in None, lambda stage, done: True:
            timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
            timer.start()
            with self.assertRaises(KeyboardInterrupt):
                octalux.bake(self.scene, path, radiance_size=1024, noise=0.001, progress=progress)
            timer.join()
            self.assertFalse(path.exists())
            self.assertIs(signal.getsignal(signal.SIGINT), before)


class Images(Packaged):
    def test_pictures_have_layers(self):
        picture = octalux.render(self.scene, self.field, width=40, height=30, spp=1)
        self.assertEqual((picture.width, picture.height), (40, 30))
        self.assertEqual((picture["beauty"].shape, picture["depth"].shape), ((30, 40, 3), (30, 40)))
        self.assertTrue((picture["depth"] > 0).all())
        self.assertNotIn("standard_error", picture.layers)
        camera = self.scene.cameras[0]
        again = octalux.render(self.scene, self.field, camera, width=40, height=30, spp=1, sample={"tracer": "texel"})
        np.testing.assert_array_equal(picture["albedo"], again["albedo"])
        np.testing.assert_array_equal(picture["indirect_glossy"], again["indirect_glossy"])

    def test_pictures_come_back_from_files(self):
        picture = octalux.render(self.scene, width=24, height=20, spp=2, bounces=3, standard_error=True)
        picture.save(self.path / "a.exr")
        again = octalux.load_image(self.path / "a.exr")
        self.assertEqual((again.bounces, set(again.layers)), (3, set(picture.layers)))
        for name, layer in picture.layers.items():
            np.testing.assert_array_equal(layer, again[name])
        picture.save(self.path / "a.png")
        self.assertEqual((self.path / "a.png").read_bytes()[:4], b"\x89PNG")
        self.refused(octalux.Result.FORMAT, "not an OpenEXR image but a PNG", octalux.load_image, self.path / "a.png")

    def test_errors_are_those_of_numpy(self):
        random = np.random.default_rng(3)
        a, b = (octalux.Image({"beauty": random.uniform(0, 1, (16, 20, 3))}) for _ in range(2))
        found = octalux.compare(a, b)
        difference = a["beauty"].astype(float) - b["beauty"]
        np.testing.assert_allclose(found.mse, (difference**2).mean(), rtol=1e-6)
        np.testing.assert_allclose(found.bias, difference.sum() / b["beauty"].sum(dtype=float), rtol=1e-5)
        self.assertTrue(0 < found.flip <= 1 and found.ssim < 1)
        self.assertEqual((octalux.compare(a, a).mse, octalux.compare(a, a).ssim), (0, 1))

    def test_layers_can_be_replaced(self):
        random = np.random.default_rng(5)
        values = {"beauty": random.uniform(0, 1, (16, 20, 3)), "depth": random.uniform(1, 2, (16, 20))}
        upright, replaced = octalux.Image(values), octalux.Image(values)
        for name, array in values.items():
            replaced.layers[name] = array.astype(np.float32)[::-1]
            flipped = octalux.Image({name: array[::-1].copy()})
            self.assertEqual(octalux.compare(replaced, upright, name), octalux.compare(flipped, upright, name))
            replaced.layers[name] = array  # doubles
            self.assertEqual(octalux.compare(replaced, upright, name).mse, 0)
        replaced.layers["beauty"] = values["beauty"][:, ::-1]
        replaced.save(self.path / "replaced.exr")
        saved = octalux.load_image(self.path / "replaced.exr")["beauty"]
        np.testing.assert_array_equal(saved, values["beauty"].astype(np.float32)[:, ::-1])

    def test_layers_of_another_shape_are_refused(self):
        path, reference = self.path / "refused.exr", octalux.Image({"beauty": np.ones((4, 5, 3))})
        for name, shape in (("beauty", (4, 4, 3)), ("beauty", (3, 5, 3)), ("beauty", (4, 5)), ("beauty", (4, 5, 4)),
                            ("beauty", ()), ("depth", (4, 4)), ("depth", (4, 5, 3)), ("glow", (4, 5, 3))):
            picture = octalux.Image({"beauty": np.ones((4, 5, 3))})
            picture.layers[name] = np.ones(shape)
            with self.assertRaisesRegex(ValueError, name):
                picture.save(path)
            with self.assertRaisesRegex(ValueError, name):
                octalux.compare(reference, picture)
        picture = octalux.Image({"beauty": np.ones((4, 5, 3))})
        picture.width = 6
        with self.assertRaisesRegex(ValueError, "height 4 and width 6"):
            picture.save(path)
        self.assertFalse(path.exists())

    def test_pictures_that_do_not_go_together_are_refused(self):
        a, b = octalux.Image({"beauty": np.ones((4, 5, 3))}), octalux.Image({"beauty": np.ones((5, 4, 3))})
        self.refused(octalux.Result.ARGUMENT, "", octalux.compare, a, b)
        self.refused(octalux.Result.ARGUMENT, "", octalux.compare, a, a, "direct")
        for layers in ({"beauty": np.ones((4, 5))}, {"glow": np.ones((4, 5, 3))}, {"depth": np.ones((4, 5, 3))}, {},
                       {"beauty": np.ones((4, 5, 3)), "depth": np.ones((5, 4))}, {"beauty": np.ones((0, 5, 3))}):
            with self.assertRaises(ValueError):
                octalux.Image(layers)
        with self.assertRaisesRegex(ValueError, "needs a field"):
            octalux.render(self.scene, method="field")
        self.refused(octalux.Result.ARGUMENT, "nosuch", octalux.render, self.scene, camera="nosuch", width=8, height=8)


if __name__ == "__main__":
    unittest.main()
