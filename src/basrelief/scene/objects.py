"""Objects: shapes with a material and the options of their relief."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.baking.tables import check_bake
from basrelief.errors import InputError
from basrelief.lang import Mat3, Vec2, Vec3, Vec4
from basrelief.material import Material
from basrelief.scene.checks import FAR, NEAR, NUMBERS, check_choice, check_range, settings_record
from basrelief.scene.shapes import SHAPES
from basrelief.scene.transforms import LYING, Transform, is_valid_transform, placed
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
from basrelief.techniques import SYNONYMS, TECHNIQUES, Technique, flat, relief
from basrelief.techniques.height import Smoothing
from basrelief.techniques.own import checked_technique, technique_from_file
from basrelief.techniques.technique import Projection

DEFAULT_SCALE = 0.05
"""Scale of a relief whose material has none: 5 % of a tile's width."""


@dataclass(frozen=True)
class Tiling:
    """Placement of a map on a shape.

    Parameters
    ----------
    tiles : (float, float), default (1, 1)
        Number of tiles along u and v over the whole shape; not 0, mirrored if negative.
    shift : (float, float), default (0, 0)
        Shift in tiles along u and v.
    """

    tiles: tuple[float, float] = (1.0, 1.0)
    shift: tuple[float, float] = (0.0, 0.0)

    def checked(self, owner: str) -> Tiling:
        """The tiling itself; raises InputError for numbers out of range."""
        if not all(NEAR <= abs(n) <= FAR for n in self.tiles):
            raise InputError(f"{owner} {self.tiles}: give finite numbers other than 0")
        if not all(abs(n) <= FAR for n in self.shift):
            raise InputError(f"shift {self.shift}: give finite numbers")
        return self

    def relative_to(self, main: Tiling) -> Vec4:
        """Scale (x, y) and shift (z, w) from another tiling's coordinates to this one's."""
        ratio = (self.tiles[0] / main.tiles[0], self.tiles[1] / main.tiles[1])
        shift = (self.shift[k] - main.shift[k] * ratio[k] for k in (0, 1))
        return Vec4(*ratio, *shift)

    @property
    def repeats(self) -> bool:
        """Whether coordinates leave the tile from 0 to 1; mirrored tiles lie before it."""
        return any(self.shift) or not all(0.0 < tiles <= 1.0 for tiles in self.tiles)

    def shifted(self, u: float, v: float) -> Tiling:
        """The tiling shifted by (u, v) in texture coordinates of the shape."""
        offset = (self.tiles[0] * u, self.tiles[1] * v)
        return replace(self, shift=(self.shift[0] + offset[0], self.shift[1] + offset[1]))


@dataclass(frozen=True, eq=False)
class Layer:
    """A second material over the first, of which colour and normals are used.

    On the standard surface it is a detail layer, on a landscape the material of the mountains.

    Parameters
    ----------
    material : Material
        Material of the layer.
    tiling : Tiling, default Tiling((10, 10))
        Placement of its maps on the shape.
    """

    material: Material
    tiling: Tiling = field(default_factory=lambda: Tiling((10.0, 10.0)))


OWN_TILINGS = ("base_color", "normal", "response", "emission")
"""Maps that may have a tiling of their own; response is occlusion, roughness and metallic."""
SURFACES: dict[str, Any] = {"standard": SurfaceParameters, "landscape": Landscape}
"""Surfaces with their parameter records."""


@dataclass(frozen=True, eq=False)
class Object:
    """A shape with a material, drawn with a technique.

    Parameters
    ----------
    material : Material
        Maps of the object.
    shape : {"plane", "box", "sphere", "cylinder"}, default "plane"
        Shape of the object, of size 1 in object space.
    technique : str or Technique, optional
        Name of a technique, "FILE.py:NAME", or a technique. The default is `relief`, or `flat` for
        a material without heights.
    settings : record or mapping, optional
        Settings of the technique, or the fields of them to change.
    scale : float, optional
        Height range as a fraction of a tile's width, 0 to 10. The default is the material's, else
        0.05.
    reference_height : float, optional
        Height that lies on the polygon, 0 (raised) to 1 (pushed in). The default is the
        technique's.
    projection : {"full", "biased", "limited"}, optional
        Projection of the view ray. The default is the technique's.
    bias : float, default 0.42
        Bias of the projection "biased", 0 to 100.
    heights : {"sharp", "smooth", "mip"}, default "sharp"
        Level of the heights: the finest; blended levels, with the parameters `smoothing`; or the
        level whose texels match the pixel's footprint.
    smoothing : record or mapping, optional
        Parameters of smooth heights, or the fields of them to change.
    fade : (float, float), optional
        Distances from the camera in world units at which the relief begins to fade and has
        vanished.
    edge : {"wrap", "clamp", "clip"}, default "wrap"
        Beyond the border of the maps (and of a layer), repeat them, continue the border, or draw
        nothing.
    tiling : (float, float), optional
        Number of tiles of all maps along u and v; not 0, mirrored if negative. The default depends
        on the shape.
    shift : (float, float), default (0, 0)
        Shift of all maps in tiles along u and v.
    tilings : mapping of str to Tiling, optional
        Tilings of single maps: "base_color", "normal", "response" (occlusion, roughness, metallic)
        and "emission".
    mapping : {"planar", "triplanar"}, default "planar"
        Projection of the colour onto the relief, from one side or from three.
    alpha : {"blend", "mask", "opaque"}, default "blend"
        Use of the opacity: blending, a cut-out, or none.
    casts : {"shape", "opaque", "none"}, default "shape"
        Shadows cast on other objects: with cut-outs, as if there were none, or no shadows.
    surface : {"standard", "landscape"}, default "standard"
        Surface shader.
    surface_parameters : record or mapping, optional
        Parameters of the surface, or the fields of them to change.
    layer : Layer, optional
        A second material over the first.
    transform : array_like, shape (4, 4), optional
        Affine transform from object to world space. By default a plane lies flat, with the
        proportions of its maps; other shapes are not transformed.

    Raises
    ------
    InputError
        For values out of range, unknown names and settings, and a technique other than `flat` for
        a material without heights.
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
            check_choice(name, getattr(self, name), values)
        check_range("scale", self.relief_scale, 0.0, 10.0)
        check_range("reference_height", self.relief_reference_height, 0.0, 1.0)
        check_range("bias", self.bias, 0.0, 100.0)
        supported = self.selected_technique.takes_heights
        if self.heights not in supported:
            raise InputError(
                f"{self.selected_technique.name} reads its heights {' or '.join(supported)}; "
                f"omit heights {self.heights}"
            )
        self._check_fade()
        self._check_tilings()
        for name, record, owner in (
            ("settings", self.selected_technique.settings, self.selected_technique.name),
            ("smoothing", Smoothing, "the smoothing"),
            ("surface_parameters", SURFACES[self.surface], f"the {self.surface} surface"),
        ):
            object.__setattr__(self, name, settings_record(record, getattr(self, name), owner))
        if not is_valid_transform(self.to_world):
            raise InputError(
                "an object's transform must be finite, affine (4 × 4, the last row 0 0 0 1), "
                "and invertible"
            )

    def _check_kinds(self) -> None:
        """Raise InputError for values of the wrong type."""
        if not isinstance(self.material, Material):
            raise InputError(f"material is {self.material!r}: give a Material, as from load")
        if not (self.layer is None or isinstance(self.layer, Layer)):
            raise InputError(f"layer is {self.layer!r}: give a Layer(material, Tiling((10, 10)))")
        for name, tiling in self.tilings.items():
            if not isinstance(tiling, Tiling):
                raise InputError(f"tiling of {name} is {tiling!r}: give a Tiling((2, 2))")
        for name in ("scale", "reference_height", "bias"):
            number = getattr(self, name)
            if not (number is None or isinstance(number, NUMBERS)):
                raise InputError(f"{name} is {number!r}: give a number")
        for name in ("fade", "tiling", "shift"):
            pair = getattr(self, name)
            if pair is not None and (not np.iterable(pair) or len(list(pair)) != 2):
                raise InputError(f"{name} is {pair!r}: give two numbers")

    def _choose_technique(self) -> None:
        default = flat if self.material.height is None else relief
        technique = default if self.technique is None else technique_named(self.technique)
        object.__setattr__(self, "technique", technique)
        if self.material.height is None and self.selected_technique is not flat:
            raise InputError(
                f"{self.material.name} has no height map, which "
                f"{self.selected_technique.name} needs; "
                "add one, or draw it with the technique flat"
            )
        check_bake(self.selected_technique.bake, self.selected_technique.name)

    def _check_fade(self) -> None:
        if self.fade is None:
            return
        near, far = self.fade
        if not 0.0 <= near < far <= FAR:
            raise InputError(f"fade {near:g} to {far:g}: give two distances, the nearer first")

    def _check_tilings(self) -> None:
        self.main_tiling.checked("tiling")
        for name, tiling in self.tilings.items():
            check_choice("a tiling of its own", name, OWN_TILINGS)
            tiling.checked(f"tiling of {name}")
        if self.layer is not None:
            self.layer.tiling.checked("tiling of the layer")

    @property
    def selected_technique(self) -> Technique[..., Any]:
        """The technique as a record, resolved from its name."""
        assert isinstance(self.technique, Technique)
        return self.technique

    @property
    def has_relief(self) -> bool:
        """Whether the object has heights and a technique that reads them."""
        return self.material.height is not None and self.selected_technique is not flat

    @property
    def relief_scale(self) -> float:
        """The scale in use: the height range as a fraction of a tile's width."""
        return _first_set(self.scale, self.material.scale, DEFAULT_SCALE)

    @property
    def relief_reference_height(self) -> float:
        """The reference height in use."""
        return _first_set(self.reference_height, self.selected_technique.reference_height)

    @property
    def raised(self) -> float:
        """Largest height of the relief above the polygon, in object space."""
        if not self.has_relief:
            return 0.0
        width = SHAPES[self.shape].width
        return (1.0 - self.relief_reference_height) * self.relief_scale * width / abs(self.tiles[0])

    @property
    def relief_projection(self) -> Projection:
        """The projection in use."""
        return self.projection or self.selected_technique.projection

    @property
    def tiles(self) -> tuple[float, float]:
        """Tiles along u and v; on round shapes more along v for wide tiles."""
        if self.tiling is not None:
            return self.tiling
        properties = SHAPES[self.shape]
        u, v = properties.tiles
        return u, v * self.material.proportion if properties.round else v

    @property
    def to_world(self) -> Transform:
        """The transform in use, from object to world space, (4, 4)."""
        if self.transform is not None:
            return np.asarray(self.transform, np.float64)
        if not SHAPES[self.shape].flat:
            return np.eye(4)
        proportion = self.material.proportion
        # z is scaled like x, since the scale of a relief is a fraction of a tile's width
        width = min(proportion, 1.0)
        return LYING @ placed(scale=(width, min(1.0 / proportion, 1.0), width))

    def bounding_points(self) -> NDArray[np.float64]:
        """World-space points, (n, 3), whose convex hull encloses the object without its relief."""
        matrix = self.to_world
        return SHAPES[self.shape].bounding_points @ matrix[:3, :3].T + matrix[:3, 3]

    def placement(self) -> Placement:
        """The shaders' record of the object's position and tiling."""
        matrix = self.to_world
        inverse = np.linalg.inv(matrix[:3, :3])
        return Placement(
            Vec3(*matrix[:3, 3]),
            _matrix_columns(inverse),
            Vec2(*self.tiles),
            Vec2(*self.shift),
            self._normals_proportion(),
        )

    def _normals_proportion(self) -> float:
        """Width ÷ height, in tiles of the heights, of a square in the normal map."""
        own_tiling = self.tilings.get("normal")
        if own_tiling is None or self.material.normal is None:
            return self.material.proportion
        ratio = own_tiling.relative_to(self.main_tiling)
        return self.material.proportion * abs(float(ratio.x / ratio.y))

    def relief_parameters(self) -> ReliefParameters:
        """The shaders' record of scale, reference height, bias and fade."""
        return ReliefParameters(
            self.relief_scale, self.relief_reference_height, self.bias, *(self.fade or (0.0, 0.0))
        )

    @property
    def main_tiling(self) -> Tiling:
        """Tiling of the heights, and of every map without its own."""
        return Tiling(self.tiles, self.shift)

    def map_tilings(self) -> MapTilings:
        """The shaders' record of the maps' tilings relative to the heights."""
        main = self.main_tiling
        places = {name: self.tilings.get(name, main).relative_to(main) for name in OWN_TILINGS}
        if self.layer is None:
            return MapTilings(**places, layer=main.relative_to(main), layer_normal_stretch=1.0)
        layer_tiling = self.layer.tiling.relative_to(main)
        stretch = abs(float(layer_tiling.y / layer_tiling.x))
        slant = stretch * self._normals_proportion() / self.layer.material.proportion
        return MapTilings(**places, layer=layer_tiling, layer_normal_stretch=slant)

    def scrolled(self, u: float, v: float = 0.0) -> Object:
        """The object with all maps shifted by (u, v) in texture coordinates of the shape."""
        layer = self.layer
        return replace(
            self,
            shift=self.main_tiling.shifted(u, v).shift,
            tilings={name: tiling.shifted(u, v) for name, tiling in self.tilings.items()},
            layer=layer and replace(layer, tiling=layer.tiling.shifted(u, v)),
        )


def _matrix_columns(matrix: NDArray[Any]) -> Mat3:
    return Mat3(*(Vec3(*matrix[:, column]) for column in range(3)))


def _first_set(*values: float | None) -> float:
    return next(float(value) for value in values if value is not None)


def technique_named(technique: str | Technique[..., Any]) -> Technique[..., Any]:
    """The technique for a name of the library's, FILE.py:NAME, or a technique.

    Case does not count, and hyphens are read as underscores.

    Raises InputError for unknown names and values that are no technique, and ShaderError for a
    signature that does not fit.
    """
    if not isinstance(technique, str):
        return checked_technique(technique)
    if ".py:" in technique:
        return technique_from_file(*technique.rsplit(":", 1))
    name = technique.lower().replace("-", "_").replace(" ", "_")
    if name not in TECHNIQUES:
        close = SYNONYMS.get(name) or next(iter(get_close_matches(name, TECHNIQUES, 1)), None)
        meant = f"did you mean {close}? Use" if close else "use"
        raise InputError(
            f"no technique is called {technique!r}; "
            f"{meant} one of {', '.join(TECHNIQUES)}, or FILE.py:NAME"
        )
    return TECHNIQUES[name]
