"""Objects as users describe them: shapes with a material and the options of their relief.

What is left open here, such as a scale of None, is decided in `basrelief.scene.resolve`. The
command line's help imports this module, so it imports little.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from basrelief.scene.checks import FAR, check_settings
from basrelief.scene.tilings import SHIFT_CONTROL, TILES_CONTROL, Layer, Tiling
from basrelief.settings import setting
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

if TYPE_CHECKING:
    from basrelief.material import Material
    from basrelief.scene.resolve import ResolvedObject
    from basrelief.scene.transforms import Transform
    from basrelief.techniques import Technique


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
        Technique of the library, or your own: a name, "FILE.py:NAME", or a technique. The default
        is `relief`, or `flat` for a material without heights.
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
        Bias of the projection "biased", −1 to 100. Below 0 the offsets are longer than the true
        ray's.
    heights : {"sharp", "smooth", "mip"}, default "sharp"
        Levels of the heights to read: the finest (sharp), a blend set by `smoothing` (smooth), or
        the one whose texels match the pixel's footprint (mip).
    filter : {"texel", "hardware"}, default "texel"
        Filter of the heights: texels that the shader interpolates (texel), or that of the graphics
        card, as in a game engine, on a GPU only (hardware). Techniques that solve whole cells read
        texels in any case.
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
    opening : float, optional
        Opening of a hole where the dust map lies, 0 (whole) to 1 (open). The material's heights are
        those of cracks, which open first; without a dust map the hole is that of the sample `dust`,
        and without a scale it is 0.3 deep, whatever the depth of the cracks. By default there is
        none.
    surface : {"standard", "landscape"}, default "standard"
        Surface shader.
    surface_parameters : record or mapping, optional
        Parameters of the surface, or the fields of them to change.
    mapping : {"planar", "noise", "triplanar"}, default "planar"
        Projection of the colours, also of a layer's, onto the relief: from one side, the same with
        noise where slopes stretch the texels, or from three sides.
    alpha : {"blend", "mask", "opaque"}, default "blend"
        Use of the opacity: blending, a cut-out, or none.
    casts : {"shape", "polygon", "opaque", "none"}, default "shape"
        Shadows cast on other objects: of the relief with its cut-outs (shape), of the polygon with
        the cut-outs not displaced, as the stock shaders of game engines cast them (polygon), of the
        relief as if there were no cut-outs (opaque), or no shadows (none).
    tilings : mapping of str to Tiling, optional
        Tilings of single maps: "base_color", "normal", "response" (occlusion, roughness, metallic)
        and "emission".
    layer : Layer, optional
        A second material over the first.
    layer_offset : {"scaled", "unscaled", "none"}, default "scaled"
        Parallax offset of a layer's coordinates: scaled with the layer's tiling, so that the layer
        lies on the relief; as it is for the material, so that a layer with more tiles floats; or
        none, as on the polygon.
    transform : array_like, shape (4, 4), optional
        Affine transform from object to world space. By default a plane lies flat, with the
        proportions of its maps; other shapes are not transformed.

    Raises
    ------
    InputError
        For values out of range, unknown names and settings, and a technique other than `flat`, or
        an opening, for a material without heights.
    """

    material: Material
    shape: ShapeKind = setting(default="plane", group="Relief")
    technique: str | Technique[..., Any] | None = setting(
        default=None, kind="text", spelling="NAME|FILE.py:NAME", group="Relief"
    )
    settings: Any = setting(factory=dict, kind="numbers", group="Relief")
    scale: float | None = setting(
        default=None, low=0.0, high=10.0, control={"high": 0.5, "step": 0.001}, group="Relief",
        in_tiles=True,
    )  # fmt: skip
    reference_height: float | None = setting(
        default=None, low=0.0, high=1.0, control={"step": 0.01}, group="Relief"
    )
    projection: Projection | None = setting(default=None, group="Relief")
    bias: float = setting(
        default=0.42,
        low=-1.0,
        high=100.0,
        control={"low": -0.5, "high": 2.0, "step": 0.01},
        group="Relief",
    )
    heights: HeightsKind = setting(default="sharp", group="Relief")
    filter: FilterKind = setting(default="texel", group="Relief")
    smoothing: Any = setting(factory=dict, kind="numbers", group="Relief")
    fade: tuple[float, float] | None = setting(
        default=None, low=0.0, high=FAR, control={"high": 20.0, "step": 0.05},
        spelling="NEAR,FAR", group="Relief",
    )  # fmt: skip
    edge: EdgeKind = setting(default="wrap", group="Relief")
    tiling: tuple[float, float] | None = setting(
        default=None, control=TILES_CONTROL, spelling="UxV", group="Relief"
    )
    shift: tuple[float, float] = setting(
        default=(0.0, 0.0),
        low=-FAR,
        high=FAR,
        control=SHIFT_CONTROL,
        spelling="U,V",
        group="Relief",
    )
    opening: float | None = setting(
        default=None, low=0.0, high=1.0, control={"step": 0.01}, group="Relief"
    )
    surface: SurfaceKind = setting(default="standard", group="Surface")
    surface_parameters: Any = setting(factory=dict, kind="numbers", group="Surface")
    mapping: MappingKind = setting(default="planar", group="Surface")
    alpha: AlphaKind = setting(default="blend", group="Surface")
    casts: CastsKind = setting(default="shape", group="Light")
    tilings: Mapping[str, Tiling] = setting(factory=dict, group="Surface")
    layer: Layer | None = setting(default=None, group="Surface")
    layer_offset: LayerOffsetKind = setting(default="scaled", group="Surface")
    transform: Transform | None = setting(default=None, group="Relief")
    resolved: ResolvedObject = field(init=False, repr=False)
    """The object with every option decided, which drawing and measuring read."""

    def __post_init__(self) -> None:
        check_settings(self)
        from basrelief.scene.resolve import resolve

        resolved = resolve(self)
        object.__setattr__(self, "resolved", resolved)
        if self.technique is not None:
            # loaded once: loading runs a user's file
            object.__setattr__(self, "technique", resolved.technique)

    def scrolled(self, u: float, v: float = 0.0) -> Object:
        """The object with all maps shifted by (u, v) in texture coordinates of the shape."""
        layer = self.layer
        return replace(
            self,
            shift=self.resolved.tiling.shifted(u, v).shift,
            tilings={name: tiling.shifted(u, v) for name, tiling in self.tilings.items()},
            layer=layer and replace(layer, tiling=layer.tiling.shifted(u, v)),
        )
