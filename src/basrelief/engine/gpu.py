"""GPU engine: WGSL compute shaders through WebGPU (wgpu), on Vulkan, Metal or DX12.

The only module that imports wgpu, and only when a GPU is requested.
"""

from __future__ import annotations

import contextlib
import functools
import itertools
import os
import tempfile
import threading
import weakref
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar, assert_never

import numpy as np
from numpy.typing import NDArray

from basrelief.engine.engine import PlaneBuffer, Planes, value_of
from basrelief.errors import DeviceError
from basrelief.lang.bindings import (
    FILTERED_FORMATS,
    GROUP,
    MAP_FORMATS,
    RUN,
    Binding,
    MapFormat,
    bindings,
)
from basrelief.lang.layout import pack, pack_list
from basrelief.lang.program import Program
from basrelief.lang.resources import Buffer, Edge, HeightField, Texture
from basrelief.lang.targets.wgsl import print_wgsl
from basrelief.timings import step

_T = TypeVar("_T")
_LIMITS = (
    "max-storage-buffer-binding-size",
    "max-buffer-size",
    "max-texture-dimension-2d",
    "max-storage-buffers-per-shader-stage",
)

_FEATURES = ("timestamp-query", "float32-filterable")
"""Features to use if the adapter has them: for times, and for `sampled` to read heights of 32 bits.
"""

_LOST = ("device is lost", "Could not map buffer")
"""Parts of the messages of wgpu about a lost device; the second is of a RuntimeError."""
_MAX_UNIFORMS = 256
"""Number of records that stay on the GPU."""
_MAX_STAGING_BYTES = 1 << 26
"""Largest buffer for reading that is kept; the colour of a 1920 × 1080 picture takes half of it."""
_MAX_PLANE_BYTES = 1 << 28
"""Largest buffer of the planes of a dispatch: WebGPU's default limit for buffers, 256 MiB."""
_MAX_CANVAS_BYTES = 1 << 30
"""Largest buffer of a canvas, where the GPU allows it."""


def request_adapter() -> Any:
    """The adapter that WebGPU prefers. Raises DeviceError if there is none."""
    try:
        import wgpu
    except ImportError:
        raise DeviceError("the device gpu needs wgpu; pip install 'basrelief[gpu]'") from None
    _exclude_opengl()
    try:
        return wgpu.gpu.request_adapter_sync(power_preference="high-performance")
    except Exception as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise DeviceError(
            f"no usable GPU found ({reason}); use --device cpu, or install a Vulkan driver"
        ) from None


@functools.cache
def _exclude_opengl() -> None:
    """Restrict WebGPU to Vulkan, Metal and DX12; OpenGL runs these programs badly."""
    from wgpu.backends.wgpu_native.extras import set_instance_extras

    # without a desktop session, Mesa prints a warning if this is unset
    os.environ.setdefault("XDG_RUNTIME_DIR", tempfile.gettempdir())
    # fails if the caller uses wgpu too and has set its backends already
    with contextlib.suppress(RuntimeError):
        set_instance_extras(backends=["Primary"])


class GpuEngine:
    """Engine on the adapter that WebGPU prefers. Raises DeviceError if there is none."""

    name = "gpu"

    def __init__(self) -> None:
        adapter = request_adapter()
        limits = {name: adapter.limits[name] for name in _LIMITS}
        features = [f for f in _FEATURES if f in adapter.features]
        self.adapter_info: dict[str, Any] = dict(adapter.info)
        self.gpu = adapter.request_device_sync(required_limits=limits, required_features=features)
        self.limits = limits
        self.adapter = f"{adapter.info['device']} ({adapter.info['backend_type']})"
        self.rounding = _rounding(adapter.info)
        # Mesa's software driver inlines uniforms that branches depend on, and 22.3 writes past the
        # end of its list of them; storage buffers are not affected
        self.avoids_uniform_buffers = adapter.info["device"].startswith("llvmpipe")
        self.is_lost = False
        self.filtered_format = "r32float" if "float32-filterable" in features else "r16float"
        self._pipelines: dict[str, _Pipeline] = {}
        self._uniforms: dict[bytes, Any] = {}
        self._staging: Any = None
        self._spare: Any = None
        self._uploaded: weakref.WeakKeyDictionary[Any, dict[str, Any]] = weakref.WeakKeyDictionary()
        self._lock = threading.RLock()

    def compile(self, program: Program) -> None:
        """Compile the program; only the driver caches it on disk."""
        with self.in_use():
            self._pipeline_of(program)

    @contextlib.contextmanager
    def in_use(self) -> Iterator[None]:
        """A context of one thread at a time, in which errors of the driver become DeviceError."""
        import wgpu

        with self._lock:
            try:
                yield
            except wgpu.GPUOutOfMemoryError:
                raise DeviceError(
                    "the GPU has no memory left; draw smaller pictures, keep fewer frames whose "
                    "planes are not read, or use --device cpu"
                ) from None
            except (wgpu.GPUError, RuntimeError) as error:
                if not any(part in str(error) for part in _LOST):
                    raise
                self.is_lost = True
                raise DeviceError(
                    "the GPU was lost, and with it the frames on it; draw them again"
                ) from None

    def run(
        self,
        program: Program,
        values: Mapping[str, Any],
        size: tuple[int, int],
        rows: tuple[int, int] | None = None,
    ) -> Planes:
        """Run a program over a picture of (width, height); see `Engine.run`."""
        with self.in_use():
            return self._run(program, values, size[0], rows or (0, size[1]))

    def _run(
        self, program: Program, values: Mapping[str, Any], width: int, rows: tuple[int, int]
    ) -> Planes:
        top, bottom = rows
        kinds = program.planes
        planes: Planes = {
            name: np.empty((bottom - top, width), np.float32 if t is float else np.int32)
            for name, t in kinds
        }
        rows_per_dispatch = self.max_rows(len(kinds), width, bottom - top)
        with self.prepare(program, values, (width, rows_per_dispatch)) as job:
            for first in range(top, bottom, rows_per_dispatch):
                last = min(first + rows_per_dispatch, bottom)
                job.dispatch(first, last)
                words = job.read(last - first)
                for plane, (name, _) in zip(words, kinds, strict=True):
                    planes[name][first - top : last - top] = plane.view(planes[name].dtype)
        return planes

    def canvas(self, program: Program, size: tuple[int, int]) -> GpuCanvas:
        """New planes for the results of a program; see `Engine.canvas`."""
        with self.in_use():
            return GpuCanvas(self, program.planes, size)

    def draw(
        self,
        program: Program,
        values: Mapping[str, Any],
        canvas: GpuCanvas,
        rows: tuple[int, int] | None = None,
    ) -> None:
        """Run a program over rows of a canvas; see `Engine.draw`."""
        top, bottom = rows or (0, canvas.size[1])
        size = (canvas.size[0], canvas.rows)
        with self.in_use():
            pipeline = self._pipeline_of(program)
            for first, last, planes in canvas.bands:
                if first < bottom and top < last:
                    with Job(self, pipeline, program, values, size, planes) as job:
                        job.dispatch(max(first, top), min(last, bottom), plane_row=first)

    def planes(self, count: int, size: tuple[int, int]) -> Any:
        """Buffer of planes for a picture."""
        import wgpu

        usage = wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_SRC
        return self.gpu.create_buffer(size=4 * count * size[0] * size[1], usage=usage)

    def spare_planes(self, count: int, size: tuple[int, int]) -> Any:
        """Buffer of planes for a picture: that of a canvas that is gone, if it has this size, or a
        new one. Making and freeing one takes longer than drawing on it."""
        spare, self._spare = self._spare, None
        if spare is not None and spare.size == 4 * count * size[0] * size[1]:
            return spare
        return self.planes(count, size)

    def keep_planes(self, planes: Any) -> None:
        """Keep one buffer of planes for the next canvas."""
        self._spare = planes

    @contextlib.contextmanager
    def read_back(self, buffer: Any, start: int, size: int) -> Iterator[Any]:
        """Bytes of a buffer, as a view that is valid within the context; a copy by `read_buffer`
        takes twice as long."""
        import wgpu

        with self.in_use():
            staging = self._staging_buffer(size)
            encoder = self.gpu.create_command_encoder()
            encoder.copy_buffer_to_buffer(buffer, start, staging, 0, size)
            self.gpu.queue.submit([encoder.finish()])
            staging.map_sync(wgpu.MapMode.READ, 0, size)
            yield staging.read_mapped(0, size, copy=False)
            staging.unmap()
            if size <= _MAX_STAGING_BYTES:
                self._staging = staging

    def _staging_buffer(self, size: int) -> Any:
        """Buffer of at least `size` bytes that the processor can read: the one that is kept, or a
        new one, which takes as long to make as to read."""
        import wgpu

        # it is kept again once it is read; after an interrupt it is still mapped
        staging, self._staging = self._staging, None
        if staging is not None and staging.size >= size:
            return staging
        usage = wgpu.BufferUsage.MAP_READ | wgpu.BufferUsage.COPY_DST
        return self.gpu.create_buffer(size=size, usage=usage)

    def max_rows(
        self, planes: int, width: int, height: int, most_bytes: int = _MAX_PLANE_BYTES
    ) -> int:
        """Number of rows whose planes fit in a buffer, at least 1 and at most the height."""
        limit = min(self.limits["max-storage-buffer-binding-size"], most_bytes)
        return max(1, min(height, limit // (4 * planes * width)))

    def prepare(self, program: Program, values: Mapping[str, Any], size: tuple[int, int]) -> Job:
        """Job that runs a program on pictures of at most a size, (width, height)."""
        with self.in_use():
            return Job(self, self._pipeline_of(program), program, values, size)

    def prepare_text(
        self,
        code: str,
        program: Program,
        values: Mapping[str, Any],
        size: tuple[int, int],
        resource_bindings: list[Binding] | None = None,
    ) -> Job:
        """Job that runs other WGSL with the values of a program, to compare the two.

        `resource_bindings` are those of the WGSL, by default those of the program.
        """
        if resource_bindings is None:
            resource_bindings = bindings(program.module.entry)
        with self.in_use():
            pipeline = self._pipeline(code, resource_bindings, "other WGSL")
            return Job(self, pipeline, program, values, size)

    @property
    def has_timestamps(self) -> bool:
        """Whether the adapter has timestamps."""
        return "timestamp-query" in self.gpu.features

    def seconds(self, job: Job, rows: int, times: int = 1) -> float:
        """Mean duration of a dispatch in seconds by GPU timestamps, over `times` in a row."""
        with self.in_use():
            return self._seconds(job, rows, times)

    def _seconds(self, job: Job, rows: int, times: int) -> float:
        import wgpu

        stamps = self.gpu.create_query_set(type="timestamp", count=2)
        usage = wgpu.BufferUsage.QUERY_RESOLVE | wgpu.BufferUsage.COPY_SRC
        resolved = self.gpu.create_buffer(size=16, usage=usage)
        job.dispatch(0, rows)  # warms up the clocks of the GPU
        writes = {
            "query_set": stamps,
            "beginning_of_pass_write_index": 0,
            "end_of_pass_write_index": 1,
        }
        job.dispatch(0, rows, writes, times)
        encoder = self.gpu.create_command_encoder()
        encoder.resolve_query_set(stamps, 0, 2, resolved, 0)
        self.gpu.queue.submit([encoder.finish()])
        first, last = np.frombuffer(self.gpu.queue.read_buffer(resolved), np.uint64)
        return float(last - first) * 1e-9 / times

    @step("compile")
    def _pipeline_of(self, program: Program) -> _Pipeline:
        if program.key not in self._pipelines:
            code = print_wgsl(program.module, program.edge)
            resource_bindings = bindings(program.module.entry)
            self._pipelines[program.key] = self._pipeline(
                code, resource_bindings, program.entry.name
            )
        return self._pipelines[program.key]

    def _pipeline(self, code: str, resource_bindings: list[Binding], label: str) -> _Pipeline:
        import wgpu

        if self.avoids_uniform_buffers:
            code = code.replace("var<uniform>", "var<storage, read>")
        try:
            module = self.gpu.create_shader_module(code=code, label=label)
        except wgpu.GPUError as error:
            if any(part in str(error) for part in _LOST):
                raise
            reason = " ".join(str(error).split())
            raise DeviceError(f"{label}: the GPU's driver refuses the program: {reason}") from None
        layout = self.gpu.create_bind_group_layout(
            entries=[
                _layout_entry(number, b, self.avoids_uniform_buffers)
                for number, b in enumerate(resource_bindings)
            ]
        )
        pipeline = self.gpu.create_compute_pipeline(
            layout=self.gpu.create_pipeline_layout(bind_group_layouts=[layout]),
            compute={"module": module, "entry_point": "main"},
        )
        return _Pipeline(pipeline, layout, resource_bindings)

    def resident(
        self, value: HeightField | Texture | Buffer[Any], *, filtered: bool = False
    ) -> Any:
        """Texture view or buffer of a resource on the GPU, uploaded once in its lifetime, in each
        format that programs read; `filtered` are heights for `sampled`."""
        uploaded = self._uploaded.setdefault(value, {})
        if isinstance(value, Buffer):
            if uploaded:
                return uploaded["buffer"]
            if isinstance(value, PlaneBuffer):
                uploaded["buffer"] = self._copied_planes(value)
            else:
                uploaded["buffer"] = self.buffer(pack_list(value), "STORAGE")
            return uploaded["buffer"]
        form = FILTERED_FORMATS[self.filtered_format] if filtered else MAP_FORMATS[type(value)]
        if form.texels not in uploaded:
            uploaded[form.texels] = self._texture(value, form)
        return uploaded[form.texels]

    def uniform(self, words: NDArray[np.int32]) -> Any:
        """Buffer of a record; those of the latest records are kept, since most of them are the same
        from one picture to the next."""
        key = words.tobytes()
        buffer = self._uniforms.pop(key, None)
        if buffer is None:
            buffer = self.buffer(words, "UNIFORM", "STORAGE")
        self._uniforms[key] = buffer
        if len(self._uniforms) > _MAX_UNIFORMS:
            del self._uniforms[next(iter(self._uniforms))]
        return buffer

    def _copied_planes(self, value: PlaneBuffer[Any]) -> Any:
        """Planes of a canvas, after the number of records, in a buffer of their own on the GPU."""
        import wgpu

        head = np.array([len(value), 0, 0, 0], np.int32)
        if isinstance(value.stored, np.ndarray):
            return self.buffer(np.concatenate([head, value.stored.ravel()]), "STORAGE")
        canvas, index, count = value.stored
        usage = wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_DST
        row = 4 * value.shape[1]
        buffer = self.gpu.create_buffer(size=head.nbytes + value.shape[0] * row, usage=usage)
        self.gpu.queue.write_buffer(buffer, 0, head)
        encoder = self.gpu.create_command_encoder()
        for plane, (first, last, planes) in itertools.product(range(count), canvas.bands):
            start = (index + plane) * canvas.rows * row
            target = head.nbytes + (plane * canvas.size[1] + first) * row
            encoder.copy_buffer_to_buffer(planes, start, buffer, target, (last - first) * row)
        self.gpu.queue.submit([encoder.finish()])
        return buffer

    def buffer(self, data: NDArray[Any], *usage: str) -> Any:
        """Buffer on the GPU with a copy of the data."""
        import wgpu

        flags = 0
        for name in usage:
            flags |= int(getattr(wgpu.BufferUsage, name))
        return self.gpu.create_buffer_with_data(data=np.ascontiguousarray(data), usage=flags)

    def edge_sampler(self, edge: Edge) -> Any:
        """Sampler that applies the edge of maps, without filtering."""
        mode = _ADDRESS_MODES[edge]
        return self.gpu.create_sampler(address_mode_u=mode, address_mode_v=mode)

    def filter_sampler(self, edge: Edge) -> Any:
        """Sampler of `sampled`, which filters, and applies the edge of maps."""
        mode = _ADDRESS_MODES[edge]
        return self.gpu.create_sampler(
            address_mode_u=mode, address_mode_v=mode,
            min_filter="linear", mag_filter="linear", mipmap_filter="linear",
        )  # fmt: skip

    def _texture(self, value: HeightField | Texture, form: MapFormat) -> Any:
        import wgpu

        height, width = value.shape
        limit = self.limits["max-texture-dimension-2d"]
        if max(width, height) > limit:
            raise DeviceError(
                f"a map of {width} × {height} is larger than this GPU takes ({limit}); "
                "use --device cpu, or a smaller map"
            )
        texture = self.gpu.create_texture(
            size=(width, height, 1),
            format=form.texels,
            mip_level_count=len(value.levels),
            usage=wgpu.TextureUsage.TEXTURE_BINDING | wgpu.TextureUsage.COPY_DST,
        )
        for number, level in enumerate(value.levels):
            rows, columns = level.shape[:2]
            self.gpu.queue.write_texture(
                {"texture": texture, "mip_level": number},
                np.ascontiguousarray(level, form.numpy),
                {"bytes_per_row": columns * form.texel_bytes, "rows_per_image": rows},
                (columns, rows, 1),
            )
            # submit each level, since pending uploads are in memory twice
            self.gpu.queue.submit([])
        return texture.create_view()


_ADDRESS_MODES: dict[Edge, str] = {"wrap": "repeat", "clamp": "clamp-to-edge"}
"""WebGPU's address modes of the edges."""


def _rounding(info: Mapping[str, Any]) -> str:
    """Identity of the arithmetic: the graphics card, and the compilers for it."""
    import wgpu

    parts = ("backend_type", "vendor", "device", "description")
    return ", ".join([f"wgpu {wgpu.__version__}", *(str(info[part]) for part in parts)])


@dataclass(frozen=True)
class _Pipeline:
    pipeline: Any
    layout: Any
    bindings: list[Binding]


class GpuCanvas:
    """Planes of a picture on the GPU, in bands of rows that fit in a buffer: `bands` has the first
    row, the last one excluded, and the buffer of each."""

    def __init__(
        self, engine: GpuEngine, kinds: list[tuple[str, type]], size: tuple[int, int]
    ) -> None:
        self.engine, self.kinds, self.size = engine, kinds, size
        width, height = size
        self.rows = engine.max_rows(len(kinds), width, height, _MAX_CANVAS_BYTES)
        buffer_size = (width, self.rows)
        self.bands = [
            (first, min(first + self.rows, height), engine.spare_planes(len(kinds), buffer_size))
            for first in range(0, height, self.rows)
        ]
        weakref.finalize(self, engine.keep_planes, self.bands[-1][2]).atexit = False

    def read(self, name: str, count: int = 1, *, interleaved: bool = False) -> NDArray[Any]:
        """Planes of scalars; see `Canvas.read`."""
        index = [known for known, _ in self.kinds].index(name)
        kind = np.float32 if self.kinds[index][1] is float else np.int32
        parts = [
            self._words(planes, index, count, last - first, interleaved).view(kind)
            for first, last, planes in self.bands
        ]
        return parts[0] if len(parts) == 1 else np.concatenate(parts, 0 if interleaved else 1)

    def buffer(self, name: str, record: type[_T], count: int = 1) -> PlaneBuffer[_T] | None:
        """Planes of scalars as a buffer; see `Canvas.buffer`."""
        width, height = self.size
        if 4 * (count * height * width + 4) > self.engine.limits["max-storage-buffer-binding-size"]:
            return None
        index = [known for known, _ in self.kinds].index(name)
        return PlaneBuffer(record, (count * height, width), (self, index, count))

    def _words(
        self, planes: Any, index: int, count: int, rows: int, interleaved: bool
    ) -> NDArray[np.int32]:
        """The words of `count` planes of a band, from a plane on."""
        width = self.size[0]
        size = 4 * width * self.rows
        with self.engine.read_back(planes, index * size, count * size) as mapped:
            words = np.frombuffer(mapped, np.int32).reshape(count, self.rows, width)
            words = words[:, :rows]
            # at once, not by way of a copy
            return np.array(words.transpose(1, 2, 0), order="C") if interleaved else words.copy()


class Job:
    """A program with its values on the GPU, to dispatch once or many times."""

    def __init__(
        self,
        engine: GpuEngine,
        pipeline: _Pipeline,
        program: Program,
        values: Mapping[str, Any],
        size: tuple[int, int],
        planes: Any = None,
    ) -> None:
        import wgpu

        self.engine, self.pipeline, self.size = engine, pipeline, size
        self.plane_count = len(program.planes)
        gpu = engine.gpu
        self._run = gpu.create_buffer(
            size=4 * len(RUN),
            usage=(wgpu.BufferUsage.UNIFORM | wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_DST),
        )
        self.planes = engine.planes(self.plane_count, size) if planes is None else planes
        self._buffers = [self._run] if planes is not None else [self._run, self.planes]
        entries = [
            {"binding": number, "resource": self._resource(b, program, values)}
            for number, b in enumerate(pipeline.bindings)
        ]
        self.group = gpu.create_bind_group(layout=pipeline.layout, entries=entries)

    def _resource(self, binding: Binding, program: Program, values: Mapping[str, Any]) -> Any:
        name = binding.name
        match binding.kind:
            case "run":
                return _whole_buffer(self._run)
            case "planes":
                return _whole_buffer(self.planes)
            case "sampler":
                engine = self.engine
                sampler = engine.filter_sampler if binding.filtered else engine.edge_sampler
                return sampler(program.edge)
            case "uniform":
                value = value_of(program, name, values)
                return _whole_buffer(self.engine.uniform(pack(value, binding.type)))
            case "map":
                value = value_of(program, name, values)
                return self.engine.resident(value, filtered=binding.filtered)
            case "buffer":
                return _whole_buffer(self.engine.resident(value_of(program, name, values)))
            case _:
                assert_never(binding.kind)

    def dispatch(
        self,
        first: int,
        last: int,
        timestamps: Any = None,
        times: int = 1,
        plane_row: int | None = None,
    ) -> None:
        """Compute rows first … last − 1, `times` times.

        `timestamps` are WebGPU timestamp writes; `plane_row` is the row at which the planes begin,
        by default the first one.
        """
        width = self.size[0]
        run = {
            "width": width,
            "first_row": first,
            "last_row": last,
            "plane_row": first if plane_row is None else plane_row,
            "plane_stride": width * self.size[1],
        }
        words = np.array([run[word] for word in RUN], np.uint32)
        gpu = self.engine.gpu
        gpu.queue.write_buffer(self._run, 0, words)
        encoder = gpu.create_command_encoder()
        compute = encoder.begin_compute_pass(
            **({"timestamp_writes": timestamps} if timestamps else {})
        )
        compute.set_pipeline(self.pipeline.pipeline)
        compute.set_bind_group(0, self.group)
        for _ in range(times):
            compute.dispatch_workgroups(-(-width // GROUP[0]), -(-(last - first) // GROUP[1]))
        compute.end()
        gpu.queue.submit([encoder.finish()])

    def read(self, rows: int) -> NDArray[np.int32]:
        """Planes of the last dispatch, (planes, rows, width), as 32-bit words."""
        width, stride = self.size[0], self.size[0] * self.size[1]
        raw = np.frombuffer(self.engine.gpu.queue.read_buffer(self.planes), np.int32)
        planes = raw.reshape(self.plane_count, stride)
        return planes[:, : rows * width].reshape(self.plane_count, rows, width)

    def __enter__(self) -> Job:
        return self

    def __exit__(self, *_: object) -> None:
        for buffer in self._buffers:
            buffer.destroy()


def _layout_entry(number: int, binding: Binding, avoids_uniform_buffers: bool) -> dict[str, Any]:
    import wgpu

    entry: dict[str, Any] = {"binding": number, "visibility": wgpu.ShaderStage.COMPUTE}
    match binding.kind:
        case "map":
            entry["texture"] = {"sample_type": binding.access, "view_dimension": "2d"}
        case "sampler":
            entry["sampler"] = {"type": binding.access}
        case "run" | "uniform" if avoids_uniform_buffers:
            entry["buffer"] = {"type": "read-only-storage"}
        case _:
            entry["buffer"] = {"type": binding.access}
    return entry


def _whole_buffer(buffer: Any) -> dict[str, Any]:
    """Bind group resource of a whole buffer."""
    return {"buffer": buffer, "offset": 0, "size": buffer.size}
