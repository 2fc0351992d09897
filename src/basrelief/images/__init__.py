"""Picture files and colour encoding."""

from basrelief.images.color import encode_light, look_up, srgb_decode, srgb_encode, srgb_thresholds
from basrelief.images.files import check_writable, write_bytes, write_whole
from basrelief.images.read import (
    LOSSY,
    READABLE,
    Picture,
    PictureSize,
    picture_size,
    read_picture,
)
from basrelief.images.write import (
    WRITABLE,
    check_target,
    code_bits,
    encode_png,
    write_codes,
    write_data,
    write_picture,
)

__all__ = [
    "LOSSY", "READABLE", "WRITABLE", "Picture", "PictureSize", "check_target", "check_writable",
    "code_bits", "encode_light", "encode_png", "look_up", "picture_size", "read_picture",
    "srgb_decode", "srgb_encode", "srgb_thresholds", "write_bytes", "write_codes", "write_data",
    "write_picture", "write_whole",
]  # fmt: skip
