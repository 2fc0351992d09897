"""Objects: a shape with a material, and how its relief is drawn."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.baking.tables import check_bake
from basrelief.errors import InputError
from basrelief.lang import Mat3, Vec2, Vec3, Vec4
from basrelief.material import Material
from basrelief.scene.checks import FAR, NEAR, NUMBERS, one_of, record_of, within
from basrelief.scene.shapes import SHAPES
from basrelief.scene.transforms import LYING, Transform, placed, sound
from basrelief.shading.intersection import Placement
from basrelief.shading.kinds import (
    AlphaKind,
    CastsKind,
    EdgeKind,
    HeightsKind,
    MappingKind,
    ShapeKind,
    SurfaceKind,
    menus_of,
)
from basrelief.shading.relief import ReliefParameters
from basrelief.shading.surfaces.landscape import Landscape
from basrelief.shading.surfaces.standard import SurfaceParameters
from basrelief.shading.surfaces.surface import MapTilings
from basrelief.techniques import TECHNIQUES, Technique, flat, relief
from basrelief.techniques.height import Smoothing
from basrelief.techniques.own import checked_technique, technique_from_file
from basrelief.techniques.technique import Projection

DEFAULT_SCALE = 0.05
"""The depth of a relief whose material does not say: 5 % of a tile's width."""


@dataclass(frozen=True)
class Tiling:
    """How a map lies on a shape: `tiles` along u and v over the shape, then moved by `shift`."""

    tiles: tuple[float, float] = (1.0, 1.0)
    shift: tuple[float, float] = (0.0, 0.0)

    def checked(self, owner: str) -> Tiling:
        """The same; raises InputError for numbers that make no tiling."""
        if not all(NEAR <= abs(n) <= FAR for n in self.tiles):
            raise InputError(f"{owner} {self.tiles}: give finite numbers other than 0")
        if not all(abs(n) <= FAR for n in self.shift):
            raise InputError(f"shift {self.shift}: give finite numbers")
        return self

    def beside(self, main: Tiling) -> Vec4:
        """The ratio of tiles to those of another, and the shift that is left."""
        ratio = (self.tiles[0] / main.tiles[0], self.tiles[1] / main.tiles[1])
        left = (self.shift[k] - main.shift[k] * ratio[k] for k in (0, 1))
        return Vec4(*ratio, *left)

    @property
    def repeats(self) -> bool:
        """Whether anything but the map's own tile is seen; mirrored tiles lie before it."""
        return any(self.shift) or not all(0.0 < tiles <= 1.0 for tiles in self.tiles)

    def moved(self, u: float, v: float) -> Tiling:
        """The same map, moved by a part of the shape's own texture coordinates."""
        move = (self.tiles[0] * u, self.tiles[1] * v)
        return replace(self, shift=(self.shift[0] + move[0], self.shift[1] + move[1]))


@dataclass(frozen=True, eq=False)
class Layer:
    """A second material over the first: details on the standard surface, the high ground of a
    landscape. Its colour and normals are used; `tiling` says how often they lie over the shape,
    as `Layer(material, Tiling((10, 10)))`."""

    material: Material
    tiling: Tiling = field(default_factory=lambda: Tiling((10.0, 10.0)))


OWN_TILINGS = ("base_color", "normal", "response", "emission")
"""The maps that may lie otherwise than the heights; response is occlusion, roughness, metallic."""
SURFACES: dict[str, Any] = {"standard": SurfaceParameters, "landscape": Landscape}
"""The surfaces, each with the record of its numbers."""


@dataclass(frozen=True, eq=False)
class Object:
    """A shape with a material, and how its relief is drawn.

    `technique` is a name, "FILE.py:NAME" or a technique; without one it is `relief` where there are
    heights, and asking for one where there are none is an error. `settings` is its record, or a
    mapping of the fields to change. `scale` defaults to the material's, `reference_height` and
    `projection` to the technique's. `edge` says what lies beyond the maps: "wrap", "clamp" (of a
    layer too, whose tiles then do not repeat), or "clip" (nothing).
    `heights` are read "sharp", from the finest level, "smooth", as `smoothing` says, or "mip", from
    the one level whose texels are as large as the pixel sees them. `fade` is
    the distance from the camera, in world units, up to which the relief is whole, and that at which
    it is gone.

    `tiling` counts the tiles of all maps along u and v, `shift` moves them; `tilings` are those of
    single maps (`OWN_TILINGS`). `mapping` lays the colour on from one side ("planar") or from three
    ("triplanar"). `alpha` says what opacity means: "blend", "mask" (a cut-out) or "opaque";
    `casts` whether the object casts shadows on others, "opaque" as if nothing were cut out of it.

    `surface` is "standard" or "landscape", `surface_parameters` its record or a mapping of the
    fields to change; `layer` lies over it. Raises InputError for values out of range.
    """

    material: Material
    shape: ShapeKind = "plane"
    technique: str | Technique[..., Any] | None = None
    settings: Any = field(default_factory=dict)
    scale: float | None = None
    reference_height: float | None = None
    projection: Projection | None = None
    bias: float = 0.42
    heights: HeightsKind = "sharp"
    smoothing: Any = field(default_factory=dict)
    fade: tuple[float, float] | None = None
    edge: EdgeKind = "wrap"
    tiling: tuple[float, float] | None = None
    shift: tuple[float, float] = (0.0, 0.0)
    tilings: Mapping[str, Tiling] = field(default_factory=dict)
    mapping: MappingKind = "planar"
    alpha: AlphaKind = "blend"
    casts: CastsKind = "shape"
    surface: SurfaceKind = "standard"
    surface_parameters: Any = field(default_factory=dict)
    layer: Layer | None = None
    transform: Transform | None = None

    def __post_init__(self) -> None:
        self._check_kinds()
        self._choose_technique()
        for name, values in menus_of(Object).items():
            one_of(name, getattr(self, name), values)
        within("scale", self.relief_scale, 0.0, 10.0)
        within("reference_height", self.relief_reference_height, 0.0, 1.0)
        within("bias", self.bias, 0.0, 100.0)
        able = self.drawn_with.takes_heights
        if self.heights not in able:
            raise InputError(
                f"{self.drawn_with.name} reads its heights {' or '.join(able)}; "
                f"leave heights {self.heights} away"
            )
        self._check_fade()
        self._check_tilings()
        for name, record, owner in (
            ("settings", self.drawn_with.settings, self.drawn_with.name),
            ("smoothing", Smoothing, "the smoothing"),
            ("surface_parameters", SURFACES[self.surface], f"the {self.surface} surface"),
        ):
            object.__setattr__(self, name, record_of(record, getattr(self, name), owner))
        if not sound(self.to_world):
            raise InputError(
                "an object's transform must be finite, affine (4 × 4, the last row 0 0 0 1), "
                "and not flatten it to nothing"
            )

    def _check_kinds(self) -> None:
        """Raise InputError for what is of another kind altogether."""
        if not isinstance(self.material, Material):
            raise InputError(f"an object's material is one, as load gives, not {self.material!r}")
        if not (self.layer is None or isinstance(self.layer, Layer)):
            raise InputError(f"layer is {self.layer!r}: give a Layer(material, Tiling((10, 10)))")
        for name, each in self.tilings.items():
            if not isinstance(each, Tiling):
                raise InputError(f"tiling of {name} is {each!r}: give a Tiling((2, 2))")
        for name in ("scale", "reference_height", "bias"):
            number = getattr(self, name)
            if not (number is None or isinstance(number, NUMBERS)):
                raise InputError(f"{name} is {number!r}: give a number")
        for name in ("fade", "tiling", "shift"):
            pair = getattr(self, name)
            if pair is not None and (not np.iterable(pair) or len(list(pair)) != 2):
                raise InputError(f"{name} is {pair!r}: give two numbers")

    def _choose_technique(self) -> None:
        usual = flat if self.material.height is None else relief
        chosen = usual if self.technique is None else technique_named(self.technique)
        object.__setattr__(self, "technique", chosen)
        if self.material.height is None and self.drawn_with is not flat:
            raise InputError(
                f"{self.material.name} has no height map, which {self.drawn_with.name} needs; "
                "add one, or draw it with the technique flat"
            )
        check_bake(self.drawn_with.bake, self.drawn_with.name)

    def _check_fade(self) -> None:
        if self.fade is None:
            return
        near, far = self.fade
        if not 0.0 <= near < far <= FAR:
            raise InputError(f"fade {near:g} to {far:g}: give two distances, the nearer first")

    def _check_tilings(self) -> None:
        self.main_tiling.checked("tiling")
        for name, each in self.tilings.items():
            one_of("a tiling of its own", name, OWN_TILINGS)
            each.checked(f"tiling of {name}")
        if self.layer is not None:
            self.layer.tiling.checked("tiling of the layer")

    @property
    def drawn_with(self) -> Technique[..., Any]:
        """The technique that is asked for."""
        assert isinstance(self.technique, Technique)
        return self.technique

    @property
    def has_relief(self) -> bool:
        """Whether anything is displaced: there are heights, and a technique that reads them."""
        return self.material.height is not None and self.drawn_with is not flat

    @property
    def relief_scale(self) -> float:
        """The depth of the relief as a fraction of a tile's width."""
        return _first(self.scale, self.material.scale, DEFAULT_SCALE)

    @property
    def relief_reference_height(self) -> float:
        """The height that lies on the polygon."""
        return _first(self.reference_height, self.drawn_with.reference_height)

    @property
    def raised(self) -> float:
        """How far the relief stands above the polygon at most, in lengths of object space."""
        if not self.has_relief:
            return 0.0
        width = SHAPES[self.shape].width
        return (1.0 - self.relief_reference_height) * self.relief_scale * width / abs(self.tiles[0])

    @property
    def relief_projection(self) -> Projection:
        """The name of the projection in use."""
        return self.projection or self.drawn_with.projection

    @property
    def tiles(self) -> tuple[float, float]:
        """Tiles along u and v; more along v where a tile is wider than high."""
        if self.tiling is not None:
            return self.tiling
        facts = SHAPES[self.shape]
        u, v = facts.tiles
        return u, v * self.material.proportion if facts.round else v

    @property
    def to_world(self) -> Transform:
        """The transform in use.

        Without one a flat shape lies, with the proportions of the maps; other shapes stand.
        """
        if self.transform is not None:
            return np.asarray(self.transform, np.float64)
        if not SHAPES[self.shape].flat:
            return np.eye(4)
        proportion = self.material.proportion
        # as deep as it is wide: the depth of a relief is a share of a tile's width
        width = min(proportion, 1.0)
        return LYING @ placed(scale=(width, min(1.0 / proportion, 1.0), width))

    def outline(self) -> NDArray[np.float64]:
        """Points of world space, (n, 3), that the object lies between."""
        matrix = self.to_world
        return SHAPES[self.shape].outline @ matrix[:3, :3].T + matrix[:3, 3]

    def placement(self) -> Placement:
        """The shaders' record of where the object is."""
        matrix = self.to_world
        inverse = np.linalg.inv(matrix[:3, :3])
        return Placement(
            Vec3(*matrix[:3, 3]),
            _columns(inverse),
            Vec2(*self.tiles),
            Vec2(*self.shift),
            self._normals_proportion(),
        )

    def _normals_proportion(self) -> float:
        """Width ÷ height, on a tile of the heights, of what the normals take for a square."""
        own = self.tilings.get("normal")
        if own is None or self.material.normal is None:
            return self.material.proportion
        ratio = own.beside(self.main_tiling)
        return self.material.proportion * abs(float(ratio.x / ratio.y))

    def relief_parameters(self) -> ReliefParameters:
        """The shaders' record of how deep the relief is."""
        return ReliefParameters(
            self.relief_scale, self.relief_reference_height, self.bias, *(self.fade or (0.0, 0.0))
        )

    @property
    def main_tiling(self) -> Tiling:
        """How the heights lie, and every map that has no tiling of its own."""
        return Tiling(self.tiles, self.shift)

    def map_tilings(self) -> MapTilings:
        """The shaders' record of how each map lies beside the heights."""
        main = self.main_tiling
        own = {name: self.tilings.get(name, main).beside(main) for name in OWN_TILINGS}
        if self.layer is None:
            return MapTilings(**own, layer=main.beside(main), layer_normal_stretch=1.0)
        over = self.layer.tiling.beside(main)
        stretch = abs(float(over.y / over.x))
        slant = stretch * self._normals_proportion() / self.layer.material.proportion
        return MapTilings(**own, layer=over, layer_normal_stretch=slant)

    def scrolled(self, u: float, v: float = 0.0) -> Object:
        """The same object, all its maps moved by a part of the shape's own coordinates."""
        layer = self.layer
        return replace(
            self,
            shift=self.main_tiling.moved(u, v).shift,
            tilings={name: each.moved(u, v) for name, each in self.tilings.items()},
            layer=layer and replace(layer, tiling=layer.tiling.moved(u, v)),
        )


def _columns(matrix: NDArray[Any]) -> Mat3:
    return Mat3(*(Vec3(*matrix[:, column]) for column in range(3)))


def _first(*values: float | None) -> float:
    return next(float(value) for value in values if value is not None)


def technique_named(given: str | Technique[..., Any]) -> Technique[..., Any]:
    """A technique of the library by its name, one of a user's own as FILE.py:NAME, or itself.

    Raises InputError where there is none, and for what is no technique; ShaderError for one whose
    signature does not fit.
    """
    if not isinstance(given, str):
        return checked_technique(given)
    if ".py:" in given:
        return technique_from_file(*given.rsplit(":", 1))
    if given not in TECHNIQUES:
        raise InputError(
            f"no technique is called {given!r}; use one of {', '.join(TECHNIQUES)}, or FILE.py:NAME"
        )
    return TECHNIQUES[given]
