"""Objects as the rest of the library reads them: every option decided.

`resolve` fills in what an `Object` leaves open, from its material, technique and shape.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from basrelief.baking.tables import check_bake
from basrelief.errors import InputError
from basrelief.lang import Mat3, Vec2, Vec3, Vec4
from basrelief.material import Map, Material, opened, sample
from basrelief.material.opening import DEPTH
from basrelief.scene.checks import FAR
from basrelief.scene.records import SCENE_RECORDS, settings_record
from basrelief.scene.shapes import SHAPES
from basrelief.scene.tilings import OWN_TILINGS, Layer, Tiling
from basrelief.scene.transforms import LYING, Transform, is_valid_transform, placed
from basrelief.settings import check_choice
from basrelief.settings.kinds import (
    AlphaKind,
    CastsKind,
    EdgeKind,
    FilterKind,
    HeightsKind,
    LayerOffsetKind,
    MappingKind,
    Projection,
    ShapeKind,
    SurfaceKind,
)
from basrelief.shading.intersection import Placement
from basrelief.shading.relief import ReliefParameters
from basrelief.shading.surfaces.landscape import Landscape
from basrelief.shading.surfaces.standard import SurfaceParameters
from basrelief.shading.surfaces.surface import MapTilings
from basrelief.techniques import SYNONYMS, TECHNIQUES, Technique, flat, relief
from basrelief.techniques.height import Smoothing
from basrelief.techniques.own import checked_technique, technique_from_file
from basrelief.techniques.technique import Nothing

if TYPE_CHECKING:
    from basrelief.scene.objects import Object

DEFAULT_SCALE = 0.05
"""Scale of a relief whose material has none: 5 % of a tile's width."""
DUST_SIDE = 256
"""Longer side of the default dust map where heights have one texel, and the largest in pages."""
SURFACES: dict[str, Any] = {"standard": SurfaceParameters, "landscape": Landscape}
"""Surfaces with their parameter records."""


def number_records(technique: Technique[..., Any], surface: str) -> dict[str, Any]:
    """The types of the records of numbers of an object and a scene, by their field."""
    return {
        "settings": technique.settings,
        "surface_parameters": SURFACES[surface],
        "smoothing": Smoothing,
        **{name: record for name, (record, _) in SCENE_RECORDS.items()},
    }


@dataclass(frozen=True, eq=False)
class ResolvedObject:
    """An object with every option decided.

    `material` is the opened one where an opening is set. `settings`, `smoothing` and
    `surface_parameters` are records. `fade` and `layer` are None where there is none; `transform`
    is from object to world space, (4, 4). Other fields are those of `Object`.
    """

    material: Material
    shape: ShapeKind
    technique: Technique[..., Any]
    settings: Any
    scale: float
    reference_height: float
    projection: Projection
    bias: float
    heights: HeightsKind
    filter: FilterKind
    smoothing: Any
    fade: tuple[float, float] | None
    edge: EdgeKind
    tiling: Tiling
    tilings: Mapping[str, Tiling]
    mapping: MappingKind
    alpha: AlphaKind
    casts: CastsKind
    surface: SurfaceKind
    surface_parameters: Any
    layer: Layer | None
    layer_offset: LayerOffsetKind
    transform: Transform

    @property
    def has_relief(self) -> bool:
        """Whether the object has heights and a technique that reads them."""
        return self.material.height is not None and self.technique is not flat

    @property
    def raised(self) -> float:
        """Largest height of the relief above the polygon, in object space."""
        if not self.has_relief:
            return 0.0
        width = SHAPES[self.shape].width
        return (1.0 - self.reference_height) * self.scale * width / abs(self.tiling.tiles[0])

    def bounding_points(self) -> NDArray[np.float64]:
        """World-space points, (n, 3), whose convex hull encloses the object without its relief."""
        return SHAPES[self.shape].bounding_points @ self.transform[:3, :3].T + self.transform[:3, 3]

    def placement(self) -> Placement:
        """The shaders' record of the object's position and tiling."""
        inverse = np.linalg.inv(self.transform[:3, :3])
        return Placement(
            Vec3(*self.transform[:3, 3]),
            Mat3(*(Vec3(*inverse[:, column]) for column in range(3))),
            Vec2(*self.tiling.tiles),
            Vec2(*self.tiling.shift),
            self._normals_proportion(),
        )

    def _normals_proportion(self) -> float:
        """Width ÷ height, in tiles of the heights, of a square in the normal map."""
        own_tiling = self.tilings.get("normal")
        if own_tiling is None or self.material.normal is None:
            return self.material.proportion
        ratio = relative_tiling(own_tiling, self.tiling)
        return self.material.proportion * abs(float(ratio.x / ratio.y))

    def relief_parameters(self) -> ReliefParameters:
        """The shaders' record of scale, reference height, bias and fade."""
        return ReliefParameters(
            self.scale, self.reference_height, self.bias, *(self.fade or (0.0, 0.0))
        )

    def map_tilings(self) -> MapTilings:
        """The shaders' record of the maps' tilings relative to the heights."""
        main = self.tiling
        tilings = {
            name: relative_tiling(self.tilings.get(name, main), main) for name in OWN_TILINGS
        }
        if self.layer is None:
            return MapTilings(
                **tilings, layer=relative_tiling(main, main), layer_normal_stretch=1.0
            )
        layer_tiling = relative_tiling(self.layer.tiling, main)
        tiling_ratio = abs(float(layer_tiling.y / layer_tiling.x))
        stretch = tiling_ratio * self._normals_proportion() / self.layer.material.proportion
        return MapTilings(**tilings, layer=layer_tiling, layer_normal_stretch=stretch)


def undisplaced(obj: ResolvedObject) -> ResolvedObject:
    """The object as its polygon: with its maps, which are not displaced."""
    return replace(obj, technique=flat, settings=Nothing())


def resolve(obj: Object) -> ResolvedObject:
    """The object with every option decided. Raises InputError for options that do not fit."""
    technique = _technique(obj)
    return ResolvedObject(
        material=_material(obj),
        shape=obj.shape,
        technique=technique,
        settings=settings_record(technique.settings, obj.settings, technique.name),
        scale=_first_set(obj.scale, default_scale(obj.material, obj.opening)),
        reference_height=_first_set(obj.reference_height, technique.reference_height),
        projection=obj.projection or technique.projection,
        bias=obj.bias,
        heights=_heights(obj, technique),
        filter=obj.filter,
        smoothing=settings_record(Smoothing, obj.smoothing, "the smoothing"),
        fade=_fade(obj),
        edge=obj.edge,
        tiling=_tiling(obj),
        tilings=_tilings(obj),
        mapping=obj.mapping,
        alpha=obj.alpha,
        casts=obj.casts,
        surface=obj.surface,
        surface_parameters=settings_record(
            SURFACES[obj.surface], obj.surface_parameters, f"the {obj.surface} surface"
        ),
        layer=_layer(obj),
        layer_offset=obj.layer_offset,
        transform=_transform(obj),
    )


# --- defaults ------------------------------------------------------------------------------------


def default_technique(material: Material) -> Technique[..., Any]:
    """`relief`, or `flat` for a material without heights."""
    return flat if material.height is None else relief


def default_scale(material: Material, opening: float | None = None) -> float:
    """The scale of a material, or `DEFAULT_SCALE` where it has none; of a hole its own."""
    return _first_set(None if opening is None else DEPTH, material.scale, DEFAULT_SCALE)


def dust_of(material: Material) -> Map:
    """The dust map of a material with heights, or else that of the sample `dust`.

    The sample has the size of the heights, or `DUST_SIDE` where they are a single texel.
    """
    height, proportion = material.height, material.proportion
    if material.dust is not None:
        return material.dust
    if height is not None and not height.flat:
        return _dust(height.height, height.width)
    shape = (DUST_SIDE / max(1.0, proportion), DUST_SIDE * min(1.0, proportion))
    return _dust(*(max(1, round(side)) for side in shape))


def default_tiles(shape: ShapeKind, material: Material) -> tuple[float, float]:
    """Tiles along u and v; on round shapes more along v for wide tiles."""
    facts = SHAPES[shape]
    u, v = facts.tiles
    return u, v * material.proportion if facts.round else v


def default_transform(shape: ShapeKind, material: Material) -> Transform:
    """The transform of a shape: a plane lies flat, with the proportions of its maps."""
    if not SHAPES[shape].flat:
        return np.eye(4)
    proportion = material.proportion
    # z is scaled like x, since the scale of a relief is a fraction of a tile's width
    width = min(proportion, 1.0)
    return LYING @ placed(scale=(width, min(1.0 / proportion, 1.0), width))


def _first_set(*values: float | None) -> float:
    return next(float(value) for value in values if value is not None)


# --- options that depend on one another ----------------------------------------------------------


def _technique(obj: Object) -> Technique[..., Any]:
    if not isinstance(obj.material, Material):
        raise InputError(f"material is {obj.material!r}: give a Material, as from load")
    default = default_technique(obj.material)
    technique = default if obj.technique is None else technique_named(obj.technique)
    if obj.material.height is None and technique is not flat:
        raise InputError(
            f"{obj.material.name} has no height map, which {technique.name} needs; "
            "add one, or draw it with the technique flat"
        )
    check_bake(technique.bake, technique.name)
    return technique


def _material(obj: Object) -> Material:
    check_opening(obj.material, obj.opening)
    return obj.material if obj.opening is None else _opened(obj.material, obj.opening)


def check_opening(material: Material, opening: float | None) -> None:
    """Raise InputError for an opening in a material without heights."""
    if opening is not None and material.height is None:
        raise InputError(
            f"{material.name} has no height map, in which a hole opens; "
            "add one, or omit the opening"
        )


# of a film's frames, and of objects that differ in other options
@functools.lru_cache(maxsize=2)
def _opened(material: Material, opening: float) -> Material:
    hole = opened(replace(material, dust=dust_of(material)), opening)
    # files and messages are named after the user's material
    return replace(hole, name=material.name)


@functools.lru_cache(maxsize=2)
def _dust(height: int, width: int) -> Map:
    dust = sample("dust", (height, width)).height
    assert dust is not None
    return dust


def _heights(obj: Object, technique: Technique[..., Any]) -> HeightsKind:
    supported = technique.takes_heights
    if obj.heights not in supported:
        raise InputError(
            f"{technique.name} reads its heights {' or '.join(supported)}; "
            f"omit heights {obj.heights}"
        )
    return obj.heights


def _fade(obj: Object) -> tuple[float, float] | None:
    if obj.fade is None:
        return None
    near, far = obj.fade
    if not 0.0 <= near < far <= FAR:
        raise InputError(f"fade {near:g} to {far:g}: give two distances, the nearer first")
    return near, far


def _tiling(obj: Object) -> Tiling:
    u, v = default_tiles(obj.shape, obj.material) if obj.tiling is None else obj.tiling
    return Tiling((u, v), obj.shift).checked("tiling")


def _tilings(obj: Object) -> Mapping[str, Tiling]:
    for name, tiling in obj.tilings.items():
        if not isinstance(tiling, Tiling):
            raise InputError(f"tiling of {name} is {tiling!r}: give a Tiling((2, 2))")
        check_choice("the map of a tiling", name, OWN_TILINGS)
        tiling.checked(f"tiling of {name}")
    return obj.tilings


def _layer(obj: Object) -> Layer | None:
    if not (obj.layer is None or isinstance(obj.layer, Layer)):
        raise InputError(f"layer is {obj.layer!r}: give a Layer(material, Tiling((10, 10)))")
    if obj.layer is not None:
        obj.layer.tiling.checked("tiling of the layer")
    return obj.layer


def _transform(obj: Object) -> Transform:
    if obj.transform is None:
        return default_transform(obj.shape, obj.material)
    try:
        transform = np.asarray(obj.transform, np.float64)
    except (TypeError, ValueError):
        transform = np.zeros(0)
    if not is_valid_transform(transform):
        raise InputError(
            "an object's transform must be finite, affine (4 × 4, the last row 0 0 0 1), "
            "and invertible"
        )
    return transform


def relative_tiling(tiling: Tiling, main: Tiling) -> Vec4:
    """Scale (x, y) and shift (z, w) from the coordinates of one tiling to those of another."""
    ratio = (tiling.tiles[0] / main.tiles[0], tiling.tiles[1] / main.tiles[1])
    shift = (tiling.shift[k] - main.shift[k] * ratio[k] for k in (0, 1))
    return Vec4(*ratio, *shift)


def technique_named(technique: str | Technique[..., Any]) -> Technique[..., Any]:
    """The technique of a name in the library or of FILE.py:NAME; a technique is only checked.

    Case does not count, and hyphens are read as underscores.

    Raises InputError for unknown names and values that are not techniques, and ShaderError for a
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
