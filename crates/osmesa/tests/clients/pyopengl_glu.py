"""PyOpenGL on OSMesa, with GLU: quadrics, the tessellator, gluPerspective, gluBuild2DMipmaps; and reading back."""
import ctypes
import math

import numpy
from OpenGL import osmesa
from OpenGL.GL import *
from OpenGL.GLU import *

import drawn

W, H = 320, 240


def context():
    made = osmesa.OSMesaCreateContextExt(osmesa.OSMESA_RGBA, 24, 8, 0, None)
    pixels = (ctypes.c_ubyte * (4 * W * H))()
    assert osmesa.OSMesaMakeCurrent(made, pixels, GL_UNSIGNED_BYTE, W, H)
    return made, pixels


def view():
    glClearColor(.2, .25, .3, 1)
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT)
    glEnable(GL_DEPTH_TEST)
    glMatrixMode(GL_PROJECTION)
    glLoadIdentity()
    gluPerspective(40, W / H, 1, 20)
    glMatrixMode(GL_MODELVIEW)
    glLoadIdentity()
    gluLookAt(2, -5, 3, 0, 0, 0, 0, 0, 1)


def keep(name):
    pixels = glReadPixels(0, 0, W, H, GL_RGB, GL_UNSIGNED_BYTE)
    drawn.save(name, numpy.frombuffer(pixels, numpy.uint8).reshape(H, W, 3)[::-1])
    assert glGetError() == GL_NO_ERROR


def quadrics():
    view()
    glEnable(GL_LIGHTING)
    glEnable(GL_LIGHT0)
    glEnable(GL_COLOR_MATERIAL)
    glLightfv(GL_LIGHT0, GL_POSITION, [1, -3, 4, 0])
    glMaterialfv(GL_FRONT_AND_BACK, GL_SPECULAR, [.6, .6, .6, 1])
    glMaterialf(GL_FRONT_AND_BACK, GL_SHININESS, 30)
    quadric = gluNewQuadric()
    parts = [
        ((1, .3, .2), (-1.3, 0, 0), GLU_FILL, lambda: gluSphere(quadric, .7, 32, 24)),
        ((.2, 1, .3), (.2, 0, -.6), GLU_FILL, lambda: gluCylinder(quadric, .5, .2, 1.2, 24, 6)),
        ((.3, .4, 1), (1.4, 0, 0), GLU_FILL, lambda: gluPartialDisk(quadric, .2, .7, 24, 4, 30, 270)),
        ((1, 1, .3), (0, 1.5, .4), GLU_SILHOUETTE, lambda: gluDisk(quadric, .1, .6, 12, 3)),
    ]
    for color, at, style, shape in parts:
        gluQuadricDrawStyle(quadric, style)
        glPushMatrix()
        glTranslatef(*at)
        glColor3f(*color)
        shape()
        glPopMatrix()
    keep('quadrics')
    depth = numpy.asarray(glReadPixels(0, 0, W, H, GL_DEPTH_COMPONENT, GL_FLOAT), numpy.float32)
    drawn.save('quadrics-depth', depth.reshape(H, W)[::-1])
    gluDeleteQuadric(quadric)
    glDisable(GL_LIGHTING)
    glDisable(GL_COLOR_MATERIAL)


def tessellator():
    view()
    glDisable(GL_DEPTH_TEST)
    star = [(1.6 * math.cos(math.radians(90 + 144 * i)), 1.6 * math.sin(math.radians(90 + 144 * i)), 0) for i in range(5)]
    hole = [(.2, -1.4, .2), (1.3, -1.2, .2), (1, -.3, .2), (.4, -.5, .2)]
    for rule, color in [(GLU_TESS_WINDING_ODD, (.9, .6, .2)), (GLU_TESS_WINDING_POSITIVE, (.3, .5, .9))]:
        tess = gluNewTess()
        gluTessCallback(tess, GLU_TESS_BEGIN, glBegin)
        gluTessCallback(tess, GLU_TESS_VERTEX, glVertex3dv)
        gluTessCallback(tess, GLU_TESS_END, glEnd)
        gluTessCallback(tess, GLU_TESS_COMBINE, lambda at, *rest: list(at))
        gluTessProperty(tess, GLU_TESS_WINDING_RULE, rule)
        glColor3f(*color)
        gluTessBeginPolygon(tess, None)
        for contour in [star, hole]:
            gluTessBeginContour(tess)
            for corner in contour:
                gluTessVertex(tess, corner, corner)
            gluTessEndContour(tess)
        gluTessEndPolygon(tess)
        gluDeleteTess(tess)
        glTranslatef(0, 0, -1)
        glScalef(.8, .8, 1)
    keep('tessellator')
    glEnable(GL_DEPTH_TEST)


def textured():
    view()
    x, y = numpy.meshgrid(numpy.arange(50), numpy.arange(70))
    texels = numpy.stack([x * 5, y * 3, (x // 8 + y // 8) % 2 * 255], 2).astype(numpy.uint8)
    glBindTexture(GL_TEXTURE_2D, glGenTextures(1))
    gluBuild2DMipmaps(GL_TEXTURE_2D, GL_RGB, 50, 70, GL_RGB, GL_UNSIGNED_BYTE, texels)
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR)
    glEnable(GL_TEXTURE_2D)
    listed = glGenLists(1)
    glNewList(listed, GL_COMPILE)
    glBegin(GL_QUADS)
    for s, t in [(0, 0), (1, 0), (1, 1), (0, 1)]:
        glTexCoord2f(3 * s, 3 * t)
        glVertex3f(4 * s - 2, 4 * t - 2, 0)
    glEnd()
    glEndList()
    glCallList(listed)
    glDisable(GL_TEXTURE_2D)
    keep('textured')


made, buffer = context()
quadrics()
tessellator()
textured()
osmesa.OSMesaDestroyContext(made)
drawn.end()
