"""One shaded frame, 1920 × 1080: the CPU engine against the same program on software Vulkan.

Run with the software driver alone, for example
VK_DRIVER_FILES=/usr/share/vulkan/icd.d/lvp_icd.x86_64.json python benchmarks/cpu_frame.py
"""

from __future__ import annotations

import os
import tempfile
import time

SIZE = (1920, 1080)
MOST = 0.5


def main() -> None:
    os.environ["BASRELIEF_CACHE"] = tempfile.mkdtemp()
    from scenes import alternate, plane_scene, work

    from basrelief.engine.cpu import CpuEngine
    from basrelief.engine.gpu import GpuEngine

    scene = plane_scene()
    cpu, gpu = CpuEngine(), GpuEngine()
    program, values = work(scene, SIZE, cpu)
    start = time.perf_counter()
    cpu.compile(program)
    print(f"compiled cold in {time.perf_counter() - start:.2f} s (at most 1.5)")
    start = time.perf_counter()
    CpuEngine().compile(program)
    print(f"loaded from the cache in {time.perf_counter() - start:.3f} s (at most 0.1)")
    print(f"{cpu.device} against {gpu.device}")
    with gpu.prepare(program, values, SIZE) as job:

        def on_gpu() -> None:
            job.dispatch(0, SIZE[1])
            gpu.gpu.queue.read_buffer(job.planes, 0, 4)

        tasks = {"cpu": lambda: cpu.run(program, values, SIZE), "software": on_gpu}
        # wall time is what one waits; the processors' own time hardly minds other programs
        clocks = {"wall": time.perf_counter, "processor": time.process_time}
        for kind, clock in clocks.items():
            found = alternate(tasks, clock=clock)
            shown = ", ".join(f"{name} {seconds * 1000:.0f} ms" for name, seconds in found.items())
            ratio = found["cpu"] / found["software"]
            print(f"{kind} time: {shown}, ratio {ratio:.2f} (at most {MOST})")


if __name__ == "__main__":
    main()
