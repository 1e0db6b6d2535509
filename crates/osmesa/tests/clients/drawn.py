"""Keeps what a client drew: drawn.save(name, pixels) writes FOLDER/name.png, the folder being the first argument."""
import os
import sys

import numpy
from PIL import Image

FOLDER = sys.argv[1]


def save(name, pixels):
    """Pixels are rows of RGB bytes from the top, or depths in 0..1, kept in 16 bits."""
    pixels = numpy.asarray(pixels)
    if pixels.dtype.kind == 'f':
        pixels = numpy.round(numpy.clip(pixels, 0, 1) * 65535).astype(numpy.uint16)
    Image.fromarray(numpy.ascontiguousarray(pixels)).save(os.path.join(FOLDER, name + '.png'))


def end():
    """Ends at once: what Python does at its end is no part of the test."""
    sys.stdout.flush()
    os._exit(0)
