/* OpenGL called directly: one lit torus of 102,400 triangles drawn in four ways, and a million vertices in immediate mode.
 * bench.h says how to run it. */
#include "bench.h"

enum { AROUND = 320, ACROSS = 160 };

static float vertices[AROUND * ACROSS][6];
static unsigned indices[AROUND * ACROSS * 6];

static void torus(void) {
    unsigned *index = indices;
    for (int i = 0; i < AROUND; i++)
        for (int j = 0; j < ACROSS; j++) {
            float a = 6.2831853f * i / AROUND, b = 6.2831853f * j / ACROSS, *v = vertices[i * ACROSS + j];
            v[0] = cosf(b) * cosf(a), v[1] = cosf(b) * sinf(a), v[2] = sinf(b);
            v[3] = (1 + 0.4f * cosf(b)) * cosf(a), v[4] = (1 + 0.4f * cosf(b)) * sinf(a), v[5] = 0.4f * sinf(b);
            unsigned p = i * ACROSS + j, q = (i + 1) % AROUND * ACROSS + j;
            unsigned r = i * ACROSS + (j + 1) % ACROSS, s = (i + 1) % AROUND * ACROSS + (j + 1) % ACROSS;
            unsigned both[6] = { p, q, s, p, s, r };
            for (int k = 0; k < 6; k++) *index++ = both[k];
        }
}

static void state(void) {
    float at[4] = { 1, 2, 3, 0 }, color[4] = { 0.8f, 0.5f, 0.2f, 1 };
    glMatrixMode(GL_PROJECTION);
    glFrustum(-0.4, 0.4, -0.3, 0.3, 1, 10);
    glMatrixMode(GL_MODELVIEW);
    glTranslatef(0, 0, -4.5f);
    glRotatef(-50, 1, 0, 0);
    glLightfv(GL_LIGHT0, GL_POSITION, at);
    glMaterialfv(GL_FRONT_AND_BACK, GL_AMBIENT_AND_DIFFUSE, color);
    glEnable(GL_LIGHTING), glEnable(GL_LIGHT0), glEnable(GL_DEPTH_TEST), glEnable(GL_CULL_FACE), glEnable(GL_NORMALIZE);
}

static void send(void) {
    glBegin(GL_TRIANGLES);
    for (int k = 0; k < AROUND * ACROSS * 6; k++) {
        const float *v = vertices[indices[k]];
        glNormal3fv(v), glVertex3fv(v + 3);
    }
    glEnd();
}

static void elements(void) { glDrawElements(GL_TRIANGLES, AROUND * ACROSS * 6, GL_UNSIGNED_INT, indices); }
static void from_buffer(void) { glDrawElements(GL_TRIANGLES, AROUND * ACROSS * 6, GL_UNSIGNED_INT, 0); }
static void listed(void) { glCallList(1); }

static void million(void) {
    glBegin(GL_TRIANGLES);
    for (int k = 0; k < 999999; k++) {
        const float *v = vertices[indices[k % (AROUND * ACROSS * 6)]];
        glVertex3f(v[3], v[4], v[5]);
    }
    glEnd();
}

int main(int count, char **arguments) {
    unsigned buffers[2];
    begin(count, arguments);
    torus();
    state();
    glNewList(1, GL_COMPILE);
    send();
    glEndList();
    measure("list", listed, 0.7f);
    measure("immediate", send, 0.7f);
    glInterleavedArrays(GL_N3F_V3F, 0, vertices);
    measure("arrays", elements, 0.7f);
    glGenBuffers(2, buffers);
    glBindBuffer(GL_ARRAY_BUFFER, buffers[0]), glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[1]);
    glBufferData(GL_ARRAY_BUFFER, sizeof vertices, vertices, GL_STATIC_DRAW);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, sizeof indices, indices, GL_STATIC_DRAW);
    glInterleavedArrays(GL_N3F_V3F, 0, 0);
    measure("buffers", from_buffer, 0.7f);
    glDisable(GL_LIGHTING);
    measure("1M vertices", million, 0.7f);
    return end();
}
