"""Slots: functions whose shaders a program binds, and the types that these fix."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from basrelief.lang.shader import Shader, accepted_parameters
from basrelief.lang.types import is_type_slot, type_name

Bindings = Mapping[Shader[..., Any], Shader[..., Any]]
"""The shader that is bound to each slot."""


def bound_types(bindings: Bindings) -> dict[type, Any]:
    """Types of the type slots, from the signatures of the bound shaders.

    Raises ShaderError for a shader that does not fit its slot.
    """
    types: dict[type, Any] = {}
    for slot, shader in bindings.items():
        parameters, result = slot.signature
        bound_parameters, bound_result = shader.signature
        accepted = accepted_parameters(slot, shader)
        declared = [parameters[name] for name in accepted or ()]
        pairs = [*zip(declared, bound_parameters.values(), strict=False), (result, bound_result)]
        fits = accepted is not None
        for slot_type, t in pairs:
            if is_type_slot(slot_type) and t is not slot_type:
                fits = fits and types.setdefault(slot_type, t) is t
            else:
                fits = fits and slot_type == t
        if not fits:
            raise shader.error(
                f"{shader.name}{_signature_text(shader)} does not fit the slot {slot.name}; its "
                f"signature is {_signature_text(slot)}"
            )
    return types


def _signature_text(shader: Shader[..., Any]) -> str:
    parameters, result = shader.signature
    inside = ", ".join(f"{name}: {type_name(t)}" for name, t in parameters.items())
    return f"({inside}) -> {type_name(result)}"
