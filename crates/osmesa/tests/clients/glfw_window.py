"""GLFW's null platform with an OSMesa context: a picture and its depths by way of the window."""
import glfw
import numpy
from OpenGL.GL import *

import drawn

W, H = 320, 240

glfw.init_hint(glfw.PLATFORM, glfw.PLATFORM_NULL)
assert glfw.init(), glfw.get_error()
glfw.window_hint(glfw.CONTEXT_CREATION_API, glfw.OSMESA_CONTEXT_API)
glfw.window_hint(glfw.DEPTH_BITS, 24)
window = glfw.create_window(W, H, 'picture', None, None)
assert window, glfw.get_error()
glfw.make_context_current(window)

for frame in range(3):
    glClearColor(.1, .1, .2, 1)
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT)
    glEnable(GL_DEPTH_TEST)
    glLoadIdentity()
    glRotatef(20 * frame + 10, .3, 1, .2)
    for turn in range(4):
        glRotatef(90, 0, 1, 0)
        glBegin(GL_TRIANGLE_STRIP)
        for i, (x, y) in enumerate([(-.5, -.5), (.5, -.5), (-.5, .5), (.5, .5)]):
            glColor3f(turn / 3, i / 3, 1 - turn / 3)
            glVertex3f(x, y, .5)
        glEnd()
    glfw.swap_buffers(window)

pixels = glReadPixels(0, 0, W, H, GL_RGB, GL_UNSIGNED_BYTE)
drawn.save('window', numpy.frombuffer(pixels, numpy.uint8).reshape(H, W, 3)[::-1])
depth = numpy.asarray(glReadPixels(0, 0, W, H, GL_DEPTH_COMPONENT, GL_FLOAT), numpy.float32)
drawn.save('window-depth', depth.reshape(H, W)[::-1])
assert glGetError() == GL_NO_ERROR
glfw.terminate()
drawn.end()
