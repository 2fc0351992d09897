"""Intrinsics that are shaders themselves: exp2, log2, sin, atan2 and so on.

Python and the CPU run these functions, so that they agree to the last bit; a GPU uses most of its
own. To add an intrinsic, write it here, and name the targets that have no such function. The stated
errors against the exact result, over the stated domains, are tested in
`tests/lang/test_elementary.py`. Polynomials after S. L. Moshier, Cephes Mathematical Library,
single precision, 1992.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import ParamSpec, TypeVar

from basrelief.lang.intrinsics import (
    Written,
    bits_float,
    copysign,
    fixed,
    float_bits,
    floor,
    intrinsic,
    sqrt,
)
from basrelief.lang.shader import Shader, shader

_P = ParamSpec("_P")
_R = TypeVar("_R")
ELEMENTARY: list[str] = []
"""Intrinsics that Python and the CPU compute by the shaders of this module."""


def _elementary(*written: str, **spelling: str) -> Callable[[Callable[_P, _R]], Shader[_P, _R]]:
    """Decorator of an intrinsic that is a shader, printed for the `written` targets too."""

    def mark(function: Callable[_P, _R]) -> Shader[_P, _R]:
        made = shader(function)
        parameters, result = made.signature
        ELEMENTARY.append(made.name)
        names = dict.fromkeys(("llvm", *written), Written(made.name))
        return intrinsic(fixed(result, *parameters.values()), **{**names, **spelling})(made)

    return mark


PI = 3.14159265358979
HALF_PI = 1.57079632679490
QUARTER_PI = 0.785398163397448


@shader
def times_power_of_two(x: float, n: int) -> float:
    """x · 2ⁿ for −252 ≤ n ≤ 254, in two factors: 2ⁿ may be out of range where x · 2ⁿ is not."""
    half = n >> 1
    return x * bits_float((half + 127) << 23) * bits_float((n - half + 127) << 23)


@shader
def exponential_series(r: float) -> float:
    """Polynomial of eʳ for |r| up to ½ ln 2."""
    p = 1.9875691500e-4
    p = p * r + 1.3981999507e-3
    p = p * r + 8.3334519073e-3
    p = p * r + 4.1665795894e-2
    p = p * r + 1.6666665459e-1
    p = p * r + 5.0000001201e-1
    return p * r * r + r + 1.0


@_elementary()
def exp(x: float) -> float:
    """Exponential eˣ: to 2 units in the last place."""
    clamped = min(max(x, -105.0), 89.0)
    n = floor(clamped * 1.44269504088896 + 0.5)
    # ln 2 in two parts, the first short enough for n · part to be exact
    r = clamped - n * 0.693359375 + n * 2.12194440e-4
    return times_power_of_two(exponential_series(r), int(n))


@_elementary()
def exp2(x: float) -> float:
    """Exponential 2ˣ: to 2 units in the last place."""
    clamped = min(max(x, -152.0), 129.0)
    n = floor(clamped + 0.5)
    r = (clamped - n) * 0.693147180559945
    return times_power_of_two(exponential_series(r), int(n))


@_elementary(wgsl=Written("log2_clamped"), glsl=Written("log2_clamped"))
def log2(x: float) -> float:
    """Logarithm to base 2 of a positive normal number: to 3 units in the last place.

    For 0 and below the result is a large negative number, never an infinity.
    """
    bits = float_bits(max(x, 1.17549435e-38))
    # the exponent that leaves a mantissa between sqrt ½ and sqrt 2
    n = (bits - 0x3F3504F3) >> 23
    m = bits_float(bits - (n << 23))
    t = (m - 1.0) / (m + 1.0)
    s = t * t
    p = 0.2222222222
    p = p * s + 0.2857142857
    p = p * s + 0.4
    p = p * s + 0.6666666667
    natural = t * 2.0 + t * s * p
    return float(n) + natural * 1.44269504088896


@_elementary(wgsl=Written("log_clamped"), glsl=Written("log_clamped"))
def log(x: float) -> float:
    """Natural logarithm of a positive normal number: to 4 units in the last place."""
    return log2(x) * 0.693147180559945


@_elementary(wgsl=Written("power"), glsl=Written("power"))
def pow(x: float, y: float) -> float:
    """Power xʸ for x ≥ 0: relative error at most 2e-7 · (1 + |y · log2 x|); 0ʸ is 0, 0⁰ is 1."""
    return exp2(y * log2(x)) if x > 0.0 else (1.0 if y == 0.0 else 0.0)


@shader
def sine_and_quarter(x: float, quarter: int) -> float:
    """sin(x + quarter · π/2) for |x| up to 8192: absolute error at most 1e-7."""
    n = floor(x * 0.636619772367581 + 0.5)
    # π/2 in three parts (W. J. Cody and W. Waite, Software Manual, 1980)
    r = x - n * 1.5703125 - n * 4.837512969970703125e-4 - n * 7.54978995489188216e-8
    q = int(n) + quarter
    z = r * r
    p = -1.9515295891e-4
    p = p * z + 8.3321608736e-3
    p = p * z - 1.6666654611e-1
    sine = p * z * r + r
    p = 2.443315711809948e-5
    p = p * z - 1.388731625493765e-3
    p = p * z + 4.166664568298827e-2
    cosine = p * z * z - 0.5 * z + 1.0
    value = cosine if (q & 1) == 1 else sine
    return -value if (q & 2) == 2 else value


@_elementary()
def sin(x: float) -> float:
    """Sine of an angle in radians, |x| up to 8192: absolute error at most 1e-7."""
    return sine_and_quarter(x, 0)


@_elementary()
def cos(x: float) -> float:
    """Cosine of an angle in radians, |x| up to 8192: absolute error at most 1e-7."""
    return sine_and_quarter(x, 1)


@_elementary()
def tan(x: float) -> float:
    """Tangent, sin(x) / cos(x)."""
    return sin(x) / cos(x)


# WGSL allows errors of 4096 units in the last place in its atan, atan2, asin and acos; GLSL states
# none


@_elementary("wgsl", "glsl")
def atan(x: float) -> float:
    """Arc tangent, −π/2 to π/2: to 3 units in the last place."""
    a = abs(x)
    base = 0.0
    r = a
    if a > 2.414213562373095:
        base = HALF_PI
        r = -1.0 / a
    elif a > 0.414213562373095:
        base = QUARTER_PI
        r = (a - 1.0) / (a + 1.0)
    z = r * r
    p = 8.05374449538e-2
    p = p * z - 1.38776856032e-1
    p = p * z + 1.99777106478e-1
    p = p * z - 3.33329491539e-1
    return copysign(base + (p * z * r + r), x)


@_elementary("wgsl", "glsl")
def atan2(y: float, x: float) -> float:
    """Angle of the point (x, y), −π to π: absolute error at most 4e-7; 0 at the origin."""
    a = abs(x)
    b = abs(y)
    larger = max(a, b)
    angle = 0.0
    if larger > 0.0:
        r = atan(min(a, b) / larger)
        angle = HALF_PI - r if b > a else r
        angle = PI - angle if x < 0.0 else angle
    return copysign(angle, y)


@shader
def arc_sine_series(x: float, z: float) -> float:
    """Polynomial of asin(x) for 0 ≤ x ≤ ½, z = x²."""
    p = 4.2163199048e-2
    p = p * z + 2.4181311049e-2
    p = p * z + 4.5470025998e-2
    p = p * z + 7.4953002686e-2
    p = p * z + 1.6666752422e-1
    return p * z * x + x


@_elementary("wgsl", "glsl")
def asin(x: float) -> float:
    """Arc sine of x clamped to −1 … 1: absolute error at most 3e-7."""
    a = min(abs(x), 1.0)
    z = (1.0 - a) * 0.5 if a > 0.5 else a * a
    r = sqrt(z) if a > 0.5 else a
    value = arc_sine_series(r, z)
    return copysign(HALF_PI - value * 2.0 if a > 0.5 else value, x)


@_elementary("wgsl", "glsl")
def acos(x: float) -> float:
    """Arc cosine of x clamped to −1 … 1: absolute error at most 4e-7."""
    a = min(abs(x), 1.0)
    z = (1.0 - a) * 0.5 if a > 0.5 else a * a
    r = sqrt(z) if a > 0.5 else a
    value = arc_sine_series(r, z)
    if a > 0.5:
        small = value * 2.0
        return PI - small if x < 0.0 else small
    return HALF_PI + value if x < 0.0 else HALF_PI - value


@_elementary()
def sign(x: float) -> float:
    """Sign of a number: 1 above 0, −1 below, and 0 for 0 and NaN; exact."""
    return 1.0 if x > 0.0 else (-1.0 if x < 0.0 else 0.0)
