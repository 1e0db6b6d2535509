"""compare.py OURS MESA: compares the pictures of two folders of the same shape, prints a table, fails if one is wrong.

A pixel differs if one of its components does by more than 8 of 255. Allowed: a tenth of a percent of depths and ids,
1.5 percent and 32 dB of everything else, but for what LIMITS names. A picture's folder is its client.
"""
import os
import sys

import numpy
from PIL import Image

ours, mesa = sys.argv[1:3]
# Words in a picture's name: most percent of different pixels, least decibels.
LIMITS = {
    'depth': (.1, 0),
    'segmentation': (.1, 0),
    # Edges that polygons share are drawn twice, in opposite directions, and the second time only passes where depths are
    # equal. Ours are, bit by bit; in Mesa some edges fall into dots.
    'wireframe': (3, 32),
    # The whole floor is lit: it lies 4 steps of a 24-bit depth before its shadow map. Mesa's interpolation of r / q is off
    # by up to 4 steps, so that its floor has black streaks far away.
    'halfcheetah': (1.5, 25),
}


def read(path):
    """Pixels in units of 1/255."""
    image = Image.open(path)
    pixels = numpy.asarray(image, float)
    return pixels / 257 if image.mode.startswith('I') else pixels


def verdict(client, name):
    paths = [os.path.join(folder, client, name) for folder in (ours, mesa)]
    if not all(map(os.path.exists, paths)):
        return '', '', 'missing'
    a, b = map(read, paths)
    if a.shape != b.shape:
        return '', '', 'sizes differ'
    if b.max() == b.min():
        return '', '', 'empty'
    apart = numpy.abs(a - b)
    far = 100 * (apart > 8).reshape(*a.shape[:2], -1).any(2).mean()
    square = (apart ** 2).mean()
    decibels = 10 * numpy.log10(255 ** 2 / square) if square else numpy.inf
    most, least = next((limit for word, limit in LIMITS.items() if word in name), (1.5, 32))
    fine = far <= most and decibels >= least
    return '%.3f' % far, '%.1f' % decibels, 'ok' if fine else 'DIFFERS'


rows = []
for client in sorted(set(os.listdir(ours)) | set(os.listdir(mesa))):
    folders = [os.path.join(folder, client) for folder in (ours, mesa)]
    names = {n for f in folders if os.path.isdir(f) for n in os.listdir(f) if n.endswith(('.png', '.ppm'))}
    rows += [(client, name, *verdict(client, name)) for name in sorted(names)]
    if not names:
        rows.append((client, '', '', '', 'nothing drawn'))
print('%-24s %-34s %8s %6s' % ('client', 'picture', '% > 8', 'PSNR'))
for row in rows:
    print('%-24s %-34s %8s %6s  %s' % row)
wrong = sum(row[-1] != 'ok' for row in rows)
print('%d pictures, %d wrong' % (len(rows), wrong))
sys.exit(1 if wrong or not rows else 0)
