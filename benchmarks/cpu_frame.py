"""One shaded frame, 1920 × 1080: the CPU engine against the same program on software Vulkan.

Run with the software driver alone, for example
VK_DRIVER_FILES=/usr/share/vulkan/icd.d/lvp_icd.x86_64.json python benchmarks/cpu_frame.py
"""

from __future__ import annotations

import os
import tempfile
import time

from figures import option_parser, store
from scenes import Seconds, alternate, plane_scene, work

from basrelief.engine.cpu import CpuEngine
from basrelief.engine.gpu import GpuEngine

SIZE = (1920, 1080)
MOST = 0.5


def main() -> None:
    options = option_parser(__doc__).parse_args()
    size, maps, runs = ((96, 54), 64, 1) if options.quick else (SIZE, 1024, 7)
    scene = plane_scene(maps)
    program, values = work(scene, size)
    cpu, gpu = CpuEngine(), GpuEngine()
    with tempfile.TemporaryDirectory() as folder:
        os.environ["BASRELIEF_CACHE"] = folder
        start = time.perf_counter()
        cpu.compile(program)
        cold = time.perf_counter() - start
        print(f"compiled cold in {cold:.2f} s (at most 1.5)")
        start = time.perf_counter()
        CpuEngine().compile(work(scene, size)[0])
        cached = time.perf_counter() - start
        print(f"loaded from the cache in {cached:.3f} s (at most 0.1)")
    print(f"{cpu.device} against {gpu.device}")
    figures = {"compiled cold, s": cold, "loaded from the cache, s": cached}
    with gpu.prepare(program, values, size) as job:

        def on_gpu() -> None:
            job.dispatch(0, size[1])
            gpu.gpu.queue.read_buffer(job.planes, 0, 4)

        tasks = {"cpu": lambda: cpu.run(program, values, size), "software": on_gpu}
        frames = alternate(tasks, runs)
    # wall time is what one waits; the processors' own time hardly minds other programs
    for clock in Seconds._fields:
        seconds = {name: getattr(taken, clock) for name, taken in frames.items()}
        ratio = seconds["cpu"] / seconds["software"]
        shown = ", ".join(f"{name} {each * 1000:.0f} ms" for name, each in seconds.items())
        print(f"{clock} time: {shown}, ratio {ratio:.2f} (at most {MOST})")
        figures |= {f"{name}, {clock} ms": each * 1000 for name, each in seconds.items()}
        figures[f"cpu ÷ software, {clock}"] = ratio
    store(options.json, figures)


if __name__ == "__main__":
    main()
