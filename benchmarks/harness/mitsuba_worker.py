"""Renders one picture with Mitsuba 3 and prints a line of JSON: mitsuba_worker.py VARIANT SCENE.xml OUT.npy SPP SEED THREADS [KEY=VALUE]...

Loading the scene and compiling kernels are timed apart. The scene's folder may hold `volpath_emis.py`, an integrator
that adds emission to media.
"""

import json
import resource
import sys
import time
from pathlib import Path


def main(variant, scene_file, out, spp, seed, threads, *settings):
    import drjit
    import mitsuba
    import numpy

    mitsuba.set_variant(variant)
    drjit.set_thread_count(int(threads))
    just_in_time = variant.startswith("llvm")
    if just_in_time:
        drjit.set_flag(drjit.JitFlag.KernelHistory, True)
        plugin = Path(scene_file).parent
        if (plugin / "volpath_emis.py").exists():
            sys.path.insert(0, str(plugin))
            __import__("volpath_emis")
    start = time.perf_counter()
    scene = mitsuba.load_file(scene_file, spp=int(spp), **dict(setting.split("=") for setting in settings))
    load = time.perf_counter() - start
    if just_in_time:
        drjit.kernel_history_clear()

    start, cpu_start = time.perf_counter(), cpu()
    image = numpy.array(mitsuba.render(scene, seed=int(seed)), dtype="f4")
    seconds, cpu_seconds = time.perf_counter() - start, cpu() - cpu_start
    # In milliseconds; one thread compiles.
    kernels = drjit.kernel_history() if just_in_time else []
    compiling = sum(kernel.get("codegen_time", 0) + kernel.get("backend_time", 0) for kernel in kernels) / 1000
    numpy.save(out, image)
    print(
        json.dumps(
            {
                "seconds": seconds - compiling,
                "cpu_seconds": cpu_seconds - compiling,
                "load_seconds": load,
                "compile_seconds": compiling,
                "version": mitsuba.__version__,
            }
        )
    )


def cpu():
    """Seconds that all threads have computed."""
    return sum(resource.getrusage(resource.RUSAGE_SELF)[:2])


if __name__ == "__main__":
    main(*sys.argv[1:])
