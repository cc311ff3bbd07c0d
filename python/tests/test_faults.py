# SPDX-License-Identifier: Apache-2.0
"""Odd buffers, threads, fork, Ctrl-C: the right result or an exception."""
import array
import concurrent.futures
import gc
import os
import random
import signal
import subprocess
import sys
import unittest

import imukit

try:
    import numpy
except ImportError:
    numpy = None


def noise(count, seed=1):
    draw = random.Random(seed)
    return array.array("d", (draw.gauss(0, 1) for _ in range(count)))


def oadev(data, **named):
    return list(imukit.allan(data, 1, **named).curve().deviation)


class Buffers(unittest.TestCase):
    def test_read_only(self):
        x = noise(300)
        self.assertEqual(oadev(memoryview(x).toreadonly()), oadev(x))
        self.assertEqual(oadev(memoryview(x.tobytes()).cast("d")), oadev(x))

    def test_released(self):
        view = memoryview(noise(300))
        view.release()
        with self.assertRaises(ValueError):
            oadev(view)

    def test_borrowed_only_for_the_call(self):
        x = noise(300)
        oadev(x)
        x.append(1.0)  # BufferError while anything holds the array

    def test_resized_meanwhile(self):
        x = noise(300)

        def resize(*said):
            with self.assertRaises(BufferError):
                x.append(1.0)

        oadev(x, progress=resize)

    def test_result_outlives_its_source(self):
        result = imukit.allan(noise(300), 1)
        curve = result.curve()
        due = list(curve.tau)
        del result
        gc.collect()
        self.assertEqual(list(curve.tau), due)

    def test_infinite_and_huge(self):
        for bad in (float("inf"), float("-inf"), 1e300):
            x = noise(300)
            x[5] = bad
            with self.subTest(bad), self.assertWarns(imukit.DataWarning):
                self.assertLess(max(oadev(x)), 10)
        with self.assertRaises(imukit.Error):
            oadev([float("nan")] * 100)

    @unittest.skipIf(numpy is None, "needs NumPy")
    def test_arrays_of_numpy(self):
        x = numpy.array(noise(300))
        due = oadev(x)
        forms = {"big-endian": x.astype(">f8"), "columns": numpy.c_[x, x][:, 1],
                 "backwards": x[::-1].copy()[::-1], "frozen": x.copy(),
                 "odd address": numpy.frombuffer(b"!" + x.tobytes(), "u1")[1:].view("f8"),
                 "field": numpy.array([(1, v) for v in x], [("a", "u1"), ("b", "f8")])["b"]}
        forms["frozen"].flags.writeable = False
        for name, form in forms.items():
            with self.subTest(name):
                self.assertEqual(oadev(form), due)
        self.assertEqual(oadev(x[:, None]), due)
        two = imukit.allan(numpy.asfortranarray(numpy.c_[x, x]), 1).curves
        self.assertEqual([list(c.deviation) for c in two], [due, due])
        for name, form in {"complex": x + 0j, "text": x.astype(str), "object": x.astype(object),
                           "date": x.astype("datetime64[s]"),
                           "records": numpy.zeros(300, [("a", "f8"), ("b", "f8")])}.items():
            with self.subTest(name), self.assertRaises((TypeError, ValueError)):
                oadev(form)
        with self.assertRaises(ValueError):
            oadev(x.reshape(3, 10, 10))
        with self.assertRaises((TypeError, ValueError)):
            oadev(numpy.float64(3).reshape(()))


    @unittest.skipIf(numpy is None, "needs NumPy")
    def test_masked_is_nan(self):
        x = numpy.array(noise(300))
        holes = x.copy()
        holes[50:60] = numpy.nan
        masked = numpy.ma.masked_invalid(holes)
        masked.data[50:60] = 1e6
        with self.assertWarns(imukit.DataWarning):
            due = oadev(holes)
        for form in masked, {"x": masked}, [masked]:
            with self.assertWarns(imukit.DataWarning):
                self.assertEqual(oadev(form), due)
        with self.assertRaises(imukit.Error):
            imukit.allantools.oadev(masked)

    @unittest.skipIf(numpy is None, "needs NumPy")
    def test_types_of_numpy(self):
        x = numpy.array(noise(300)).astype("f2")
        self.assertEqual(oadev(x), oadev(x.astype(float)))
        for kind in ("datetime64[s]", "longdouble", "O", "U8", "complex"):
            with self.subTest(kind), self.assertRaisesRegex(TypeError, "column 'wx'"):
                oadev({"wx": x.astype(kind)})

    def test_no_vector(self):
        for bad in (None, 5, 1.5, True, b"/x.csv", bytearray(b"x"), object()):
            with self.subTest(bad), self.assertRaisesRegex(TypeError, "data: expected"):
                oadev(bad)
        with self.assertRaisesRegex(TypeError, "column 'wx'"):
            oadev({"wx": ["a", "b", "c"]})
        with self.assertRaisesRegex(TypeError, "item 1 is NoneType"):
            oadev([1.0, None, 2.0])

    def test_times(self):
        x = noise(300)
        self.assertEqual(oadev(x, tau=2.0), oadev(x, tau=[2.0]))
        for bad in ([2, 1], [1, 1], [float("nan"), 2]):
            with self.subTest(bad), self.assertRaisesRegex(ValueError, "tau: the times must asc"):
                oadev(x, tau=bad)

    def test_false_of_any_kind_stops(self):
        for said in (False, 0, "") + (() if numpy is None else (numpy.False_,)):
            with self.subTest(said), self.assertRaises(imukit.Error):
                oadev(noise(300), progress=lambda *stage: said)
        self.assertTrue(oadev(noise(300), progress=lambda *stage: None))

    def test_flags(self):
        with self.assertRaisesRegex(TypeError, "earth='no': expected True or False"):
            imukit.simulate("tactical", 100, 1, earth="no")
        with self.assertRaisesRegex(TypeError, "rate=True: expected a number"):
            imukit.allan(noise(300), rate=True)


class Threads(unittest.TestCase):
    def test_at_once(self):
        x = noise(20000)
        due = oadev(x)
        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            for found in pool.map(lambda _: oadev(x, threads=2), range(32)):
                self.assertEqual(found, due)

    def test_others_run_meanwhile(self):
        x = noise(1000)
        with concurrent.futures.ThreadPoolExecutor(1) as pool:
            # Progress waits for another thread of Python: a lock that is kept would end in this.
            said = []

            def wait(*progress):
                said.append(pool.submit(len, "abc").result(30))

            imukit.allan(x, 1, progress=wait)
        self.assertTrue(said)

    @unittest.skipUnless(hasattr(os, "fork"), "needs fork")
    def test_fork(self):
        x = noise(5000)
        due = oadev(x, threads=2)
        child = os.fork()
        if child == 0:
            os._exit(0 if oadev(x, threads=2) == due else 1)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 0)


class Interrupted(unittest.TestCase):
    def test_ctrl_c(self):
        program = ("import imukit, os, signal\n"
                   "x = [float(k * k % 101) for k in range(5000)]\n"
                   "def interrupt(*said): os.kill(os.getpid(), signal.SIGINT)\n"
                   "try:\n"
                   "    imukit.allan(x, 1, progress=interrupt, statistic='all', tau='all')\n"
                   "except KeyboardInterrupt:\n"
                   "    raise SystemExit(9)\n")
        # What a child of a shell's background job ignores would stay ignored.
        ended = subprocess.run([sys.executable, "-c", program], timeout=120,
                               preexec_fn=lambda: signal.signal(signal.SIGINT,
                                                                signal.default_int_handler))
        self.assertEqual(ended.returncode, 9)

    def test_signal_without_progress(self):
        caught = []
        before = signal.signal(signal.SIGALRM, lambda *said: caught.append(1))
        try:
            signal.setitimer(signal.ITIMER_REAL, 0.01)
            while not caught:
                oadev(noise(2000))
        finally:
            signal.signal(signal.SIGALRM, before)


if __name__ == "__main__":
    unittest.main()
