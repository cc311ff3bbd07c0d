# SPDX-License-Identifier: Apache-2.0
"""Random numbers the way they are usually drawn with NumPy, into an array that exists.

usage: numpy_normals.py COUNT normals|words   prints the best time of five runs [s]
"""
import sys
import time

import numpy as np

count = int(sys.argv[1])
best = float("inf")
if sys.argv[2] == "normals":
    generator = np.random.default_rng(1)
    out = np.zeros(count)

    def draw():
        generator.standard_normal(out=out)
else:
    generator = np.random.Philox(1)

    def draw():
        generator.random_raw(count // 2, output=False)  # 64 bits each


for _ in range(5):
    start = time.perf_counter()
    draw()
    best = min(best, time.perf_counter() - start)
print(best)
