"""CPU engine: LLVM through llvmlite, one SIMD lane per pixel, rows spread over all cores."""

from __future__ import annotations

import ctypes
import functools
import os
import platform
import threading
import weakref
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

import basrelief.engine
import basrelief.lang
from basrelief.engine import cache
from basrelief.engine.engine import (
    PlaneBuffer,
    Planes,
    check_sampling,
    pack_buffer,
    pack_uniforms,
    value_of,
)
from basrelief.lang.layout import header
from basrelief.lang.program import Program
from basrelief.lang.resources import Buffer, HeightField, Texture, is_handle
from basrelief.threads import core_count
from basrelief.timings import step

_T = TypeVar("_T")
_ROWS_PER_TASK = 8
"""Rows in a task: enough to outweigh scheduling, few enough to balance the cores."""


class CpuEngine:
    """Engine that runs programs on all cores; by default with the machine's lanes and threads."""

    name = "cpu"
    rounding = "IEEE 754"
    """The same on every processor and for any number of lanes: see `CONVENTIONS.md`."""
    is_lost = False
    filtered_format = None

    def __init__(self, lanes: int | None = None, threads: int | None = None) -> None:
        self.lanes = lanes or _native_lanes()
        self.threads = threads or core_count()
        self.adapter = f"{_host()[0]}, {self.lanes} lanes, {self.threads} threads"
        self._compiled: dict[str, _Compiled] = {}
        self._layouts: weakref.WeakKeyDictionary[Any, _ResourceLayout] = weakref.WeakKeyDictionary()
        self._pool: tuple[int, ThreadPoolExecutor] | None = None
        self._lock = threading.Lock()

    def compile(self, program: Program) -> None:
        """Compile the program, or load it from memory or from the cache."""
        self._compiled_program(program)

    def run(
        self,
        program: Program,
        values: Mapping[str, Any],
        size: tuple[int, int],
        rows: tuple[int, int] | None = None,
    ) -> Planes:
        """Run a program over a picture of (width, height); see `Engine.run`."""
        canvas = CpuCanvas(program.planes, size[0], rows or (0, size[1]), self.lanes)
        self.draw(program, values, canvas)
        return {name: canvas.read(name)[0] for name, _ in program.planes}

    def canvas(self, program: Program, size: tuple[int, int]) -> CpuCanvas:
        """New planes for the results of a program; see `Engine.canvas`."""
        return CpuCanvas(program.planes, size[0], (0, size[1]), self.lanes)

    def draw(
        self,
        program: Program,
        values: Mapping[str, Any],
        canvas: CpuCanvas,
        rows: tuple[int, int] | None = None,
    ) -> None:
        """Run a program over rows of a canvas; see `Engine.draw`."""
        compiled = self._compiled_program(program)
        handles = [n for n in compiled.parameters if is_handle(program.parameters[n])]
        records = [n for n in compiled.parameters if n not in handles]
        layouts = [self._layout_of(value_of(program, name, values)) for name in handles]
        pointers = (ctypes.c_void_p * max(1, len(layouts)))(*(r.address for r in layouts))
        uniforms = pack_uniforms(program, records, values)
        planes, (first, last) = canvas.planes, rows or canvas.rows
        stride = planes.shape[2]
        # the code counts rows from the top of the picture, the planes from their own first row
        top = planes.ctypes.data - canvas.rows[0] * stride * planes.itemsize

        def run_rows(start: int) -> None:
            compiled.run(
                uniforms.ctypes.data, ctypes.addressof(pointers), top, planes[0].size, stride,
                canvas.width, start, min(start + _ROWS_PER_TASK, last),
            )  # fmt: skip

        if canvas.width:
            self._run_parallel(run_rows, range(first, last, _ROWS_PER_TASK))

    def _run_parallel(self, task: Callable[[int], None], starts: range) -> None:
        """Run a task for each start on all threads; an interrupt cancels the rest."""
        if self.threads == 1 or len(starts) == 1:
            for start in starts:
                task(start)
            return
        tasks = [self._thread_pool().submit(task, start) for start in starts]
        try:
            for each in tasks:
                each.result()
        finally:
            for each in tasks:
                each.cancel()
            # tasks that run write to the planes
            wait(tasks)

    def _thread_pool(self) -> ThreadPoolExecutor:
        """The threads, which live as long as the engine; a forked process has none, and gets its
        own."""
        with self._lock:
            if self._pool is None or self._pool[0] != os.getpid():
                self._pool = os.getpid(), ThreadPoolExecutor(self.threads)
            return self._pool[1]

    def _layout_of(self, value: Any) -> _ResourceLayout:
        with self._lock:
            if value not in self._layouts:
                self._layouts[value] = _ResourceLayout(value)
            return self._layouts[value]

    @step("compile")
    def _compiled_program(self, program: Program) -> _Compiled:
        check_sampling(program.sampling, self)
        with self._lock:
            if program.key not in self._compiled:
                self._compiled[program.key] = self._load(program)
            return self._compiled[program.key]

    def _load(self, program: Program) -> _Compiled:
        key = self._cache_key(program)
        stored = cache.read(key)
        if stored is None:
            entry = program.module.entry
            parameters = [n for n, t in entry.parameters.items() if t is not entry.result][1:]
            stored = {"parameters": parameters}, _object_code(program, self.lanes)
            cache.write(key, *stored)
        header, code = stored
        return _link(code, header["parameters"])

    def _cache_key(self, program: Program) -> str:
        import llvmlite

        # the program's key does not cover the front end, the printer and the memory layout
        source = cache.source_digest(basrelief.lang, basrelief.engine)
        parts = (
            program.key, source, self.lanes, *_host(), llvmlite.__version__, platform.machine(),
            platform.system(),
        )  # fmt: skip
        return cache.key_of("cpu", repr(parts))


class CpuCanvas:
    """Rows of the planes of a picture in memory, padded to whole groups of lanes."""

    def __init__(
        self, kinds: list[tuple[str, type]], width: int, rows: tuple[int, int], lanes: int
    ) -> None:
        self.kinds, self.width, self.rows = kinds, width, rows
        self.size = (width, rows[1] - rows[0])
        stride = -(-width // lanes) * lanes
        self.planes = np.zeros((len(kinds), rows[1] - rows[0], stride), np.int32)

    def read(self, name: str, count: int = 1, *, interleaved: bool = False) -> NDArray[Any]:
        """Planes of scalars; see `Canvas.read`."""
        index = [known for known, _ in self.kinds].index(name)
        planes = self.planes[index : index + count, :, : self.width]
        if self.kinds[index][1] is float:
            planes = planes.view(np.float32)
        return np.ascontiguousarray(planes.transpose(1, 2, 0)) if interleaved else planes

    def buffer(self, name: str, record: type[_T], count: int = 1) -> PlaneBuffer[_T] | None:
        """Planes of scalars as a buffer; see `Canvas.buffer`."""
        index = [known for known, _ in self.kinds].index(name)
        rows = self.planes[index : index + count].reshape(-1, self.planes.shape[2])
        return PlaneBuffer(record, rows.shape, rows)


# --- compiling -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Compiled:
    """Machine code in memory; `owner` keeps it alive."""

    run: Any
    parameters: list[str]
    owner: Any


@functools.cache
def _host() -> tuple[str, str]:
    """Name and features of the processor."""
    import llvmlite.binding as llvm

    return llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()


def _native_lanes() -> int:
    return 16 if "+avx512f" in _host()[1] else 8


def _target_machine() -> Any:
    """A new target machine; MCJIT takes ownership of it, so it cannot be shared."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    target = llvm.Target.from_default_triple()
    name, features = _host()
    return target.create_target_machine(cpu=name, features=features, opt=3, jit=True)


def _object_code(program: Program, lanes: int) -> bytes:
    import llvmlite.binding as llvm

    from basrelief.lang.llvm import print_llvm

    machine = _target_machine()
    module = llvm.parse_assembly(print_llvm(program.module, lanes))
    module.triple = llvm.get_default_triple()
    module.data_layout = str(machine.target_data)
    module.verify()
    # the printed code is vectorized already, so LLVM's vectorizers would only take time; level 2
    # takes 1.5 times as long as level 1, and its code is no faster
    tuning = llvm.create_pipeline_tuning_options(speed_level=1)
    tuning.loop_vectorization = tuning.slp_vectorization = tuning.loop_unrolling = False
    builder = llvm.create_pass_builder(machine, tuning)
    builder.getModulePassManager().run(module, builder)
    return machine.emit_object(module)


def _link(code: bytes, parameters: list[str]) -> _Compiled:
    import llvmlite.binding as llvm

    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _target_machine())
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    pointer, int64, int32 = ctypes.c_void_p, ctypes.c_int64, ctypes.c_int32
    signature = (pointer, pointer, pointer, int64, int32, int32, int32, int32)
    rows = ctypes.CFUNCTYPE(None, *signature)
    return _Compiled(rows(engine.get_function_address("run.rows")), parameters, engine)


# --- resources ------------------------------------------------------------------------------------


class _ResourceLayout:
    """A resource in memory as compiled code reads it: data, and a header that points to it."""

    def __init__(self, value: HeightField | Texture | Buffer[Any]) -> None:
        match value:
            case PlaneBuffer():
                self.data = value.stored
            case Buffer():
                self.data = pack_buffer(value)
            case _:
                self.data = value.storage
        self.header = header(value, self.data.ctypes.data)
        self.address = self.header.ctypes.data
