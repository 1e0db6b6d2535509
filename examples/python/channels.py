"""Colours, depths and ids of one view as numpy arrays, and side by side in a picture.

    pip install . pillow
    python3 examples/python/channels.py channels.png
"""

import sys

import numpy as np
import vitral
from PIL import Image

renderer = vitral.Renderer(vitral.load("builtin:scene0"), height=300, width=400, shadows="map")
rgb, depth, ids = renderer.render(channels=("rgb", "depth", "ids"))

# Depths as grey values, the nearest ones the brightest; the background is infinitely far away.
is_seen = np.isfinite(depth)
near, far = depth[is_seen].min(), depth[is_seen].max()
grey = np.zeros(depth.shape, np.uint8)
grey[is_seen] = 255 - 215 * (depth[is_seen] - near) / (far - near)

# A colour for each id. The background has the id -1.
colors = np.random.default_rng(4).integers(70, 256, (ids.max() + 2, 3), np.uint8)
colors[0] = 0
picture = np.hstack([rgb, np.dstack([grey] * 3), colors[ids + 1]])
Image.fromarray(picture).save(sys.argv[1], optimize=True)
