# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures as files, where there is no Blender to write them."""

from pathlib import Path

import numpy as np

FORMATS = (".png", ".exr", ".ppm", ".npy")


def save_image(path, pixels, metadata=None):
    """Write `pixels`, float32 (h, w, 3 or 4), linear, bottom row first, in the format that the name's ending tells.

    .exr and .npy keep the linear values. .png and .ppm get the sRGB curve, and colours beyond 1 are cut off; a .ppm,
    which knows no alpha, is over black. `metadata`, {name: text}, is written into the header of .png, .exr and .ppm,
    each name after "lambent.".
    Raises ValueError for another ending.
    """
    ending = Path(path).suffix.lower()
    texts = {f"lambent.{name}": text for name, text in (metadata or {}).items()}
    upright = np.ascontiguousarray(pixels[::-1])
    if ending == ".npy":
        np.save(path, upright)
    elif ending == ".exr":
        import OpenEXR

        channels = {"RGBA"[: upright.shape[2]]: upright}
        header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **texts}
        OpenEXR.File(header, channels).write(str(path))
    elif ending == ".png":
        from PIL import Image, PngImagePlugin

        color = srgb(np.clip(upright, 0.0, 1.0))
        if color.shape[2] == 4:  # PNG's alpha is not premultiplied
            alpha = np.clip(upright[..., 3:], 0.0, 1.0)
            straight = np.divide(upright[..., :3], alpha, out=np.zeros_like(upright[..., :3]), where=alpha > 0)
            color = np.concatenate([srgb(np.clip(straight, 0.0, 1.0)), alpha], axis=-1)
        info = PngImagePlugin.PngInfo()
        for name, text in texts.items():
            info.add_text(name, text)
        Image.fromarray(bytes_of(color)).save(path, pnginfo=info)
    elif ending == ".ppm":
        write_ppm(path, bytes_of(srgb(np.clip(upright[..., :3], 0.0, 1.0))), texts)
    else:
        raise ValueError(f"{path}: a picture ends in one of {', '.join(FORMATS)}")


def srgb(linear):
    """The sRGB transfer curve (IEC 61966-2-1), for values from 0 to 1."""
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 0.0031308) ** (1 / 2.4) - 0.055)


def bytes_of(color):
    """Numbers from 0 to 1 as bytes."""
    return np.round(color * 255.0).astype(np.uint8)


def write_ppm(path, pixels, texts):
    """A plain portable pixmap, to be read with the naked eye: `pixels`, uint8 (h, w, 3), top row first, in decimals.

    After the magic number P3 come comments, the size, the largest value, and a line for each pixel.
    """
    height, width = pixels.shape[:2]
    comments = "".join(f"# {name}: {text}\n" for name, text in texts.items())
    with open(path, "w", encoding="ascii", errors="replace", newline="\n") as file:
        file.write(f"P3\n{comments}{width} {height}\n255\n")
        np.savetxt(file, pixels.reshape(-1, 3), fmt="%d")
