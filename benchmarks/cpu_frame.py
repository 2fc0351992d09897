"""One shaded frame, 1920 × 1080: the CPU engine against the same program on software Vulkan.

Run with the software driver alone, for example
VK_DRIVER_FILES=/usr/share/vulkan/icd.d/lvp_icd.x86_64.json python benchmarks/cpu_frame.py
"""

from __future__ import annotations

import os
import tempfile

from figures import option_parser, store
from scenes import Seconds, alternate, plane_scene, seconds_of, work

from basrelief.engine.cpu import CpuEngine
from basrelief.engine.gpu import GpuEngine

SIZE = (1920, 1080)
MAX_RATIO = 0.5


def main() -> None:
    options = option_parser(__doc__).parse_args()
    size, maps, runs = ((96, 54), 64, 1) if options.quick else (SIZE, 1024, 7)
    scene = plane_scene(maps)
    cpu, gpu = CpuEngine(), GpuEngine()
    program, values = work(scene, size, cpu)
    with tempfile.TemporaryDirectory() as folder:
        os.environ["BASRELIEF_CACHE"] = folder
        cold = seconds_of(lambda: cpu.compile(program))
        print(f"compiled cold in {cold.wall:.2f} s (at most 1.5), {cold.processor:.2f} s processor")
        cached = seconds_of(lambda: CpuEngine().compile(work(scene, size, cpu)[0]))
        print(f"loaded from the cache in {cached.wall:.3f} s (at most 0.1)")
    print(f"{cpu.adapter} against {gpu.adapter}")
    figures = {
        "compiled cold, wall s": cold.wall,
        "compiled cold, processor s": cold.processor,
        "loaded from the cache, wall s": cached.wall,
        "loaded from the cache, processor s": cached.processor,
    }
    with gpu.prepare(program, values, size) as job:

        def on_gpu() -> None:
            job.dispatch(0, size[1])
            gpu.gpu.queue.read_buffer(job.planes, 0, 4)

        tasks = {"cpu": lambda: cpu.run(program, values, size), "software": on_gpu}
        frames = alternate(tasks, runs)
    # processor time hardly depends on other programs, wall time does
    for clock in Seconds._fields:
        seconds = {name: getattr(taken, clock) for name, taken in frames.items()}
        ratio = seconds["cpu"] / seconds["software"]
        shown = ", ".join(f"{name} {time * 1000:.0f} ms" for name, time in seconds.items())
        print(f"{clock} time: {shown}, ratio {ratio:.2f} (at most {MAX_RATIO})")
        figures |= {f"{name}, {clock} ms": time * 1000 for name, time in seconds.items()}
        figures[f"cpu ÷ software, {clock}"] = ratio
    store(options.json, figures)


if __name__ == "__main__":
    main()
