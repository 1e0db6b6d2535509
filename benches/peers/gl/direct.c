/* OpenGL called directly: one lit torus of 102,400 triangles, 640x480, one sample a pixel, drawn in four ways, and a
 * million vertices in immediate mode. Prints the median time of a frame, its end (glFinish) included.
 *
 * cc -O2 direct.c -o direct -lOSMesa -lm; run it with LD_LIBRARY_PATH at one libOSMesa and at the other.
 * The name of a way as argument measures that alone. */
#define GL_GLEXT_PROTOTYPES
#include <GL/osmesa.h>
#include <GL/gl.h>
#include <GL/glext.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { WIDTH = 640, HEIGHT = 480, AROUND = 320, ACROSS = 160, FRAMES = 21 };

static float vertices[AROUND * ACROSS][6];
static unsigned indices[AROUND * ACROSS * 6];

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * 1e3 + t.tv_nsec * 1e-6;
}

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
    glViewport(0, 0, WIDTH, HEIGHT);
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

static int by_value(const void *a, const void *b) {
    return (*(const double *)a > *(const double *)b) - (*(const double *)a < *(const double *)b);
}

static const char *only;

static void measure(const char *name, void (*draw)(void)) {
    double times[FRAMES];
    if (only && strcmp(only, name)) return;
    for (int i = -2; i < FRAMES; i++) {
        double start = now();
        glRotatef(0.7f, 0, 0, 1);
        glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
        draw();
        glFinish();
        if (i >= 0) times[i] = now() - start;
    }
    qsort(times, FRAMES, sizeof *times, by_value);
    printf("%-12s %8.2f ms\n", name, times[FRAMES / 2]);
}

int main(int count, char **arguments) {
    unsigned buffers[2];
    void *pixels = malloc(WIDTH * HEIGHT * 4);
    OSMesaContext context = OSMesaCreateContextExt(OSMESA_RGBA, 24, 8, 0, NULL);
    if (!context || !OSMesaMakeCurrent(context, pixels, GL_UNSIGNED_BYTE, WIDTH, HEIGHT)) return 1;
    printf("%s\n", (const char *)glGetString(GL_RENDERER));
    if (count > 1) only = arguments[1];
    torus();
    state();
    glNewList(1, GL_COMPILE);
    send();
    glEndList();
    measure("list", listed);
    measure("immediate", send);
    glInterleavedArrays(GL_N3F_V3F, 0, vertices);
    measure("arrays", elements);
    glGenBuffers(2, buffers);
    glBindBuffer(GL_ARRAY_BUFFER, buffers[0]), glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[1]);
    glBufferData(GL_ARRAY_BUFFER, sizeof vertices, vertices, GL_STATIC_DRAW);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, sizeof indices, indices, GL_STATIC_DRAW);
    glInterleavedArrays(GL_N3F_V3F, 0, 0);
    measure("buffers", from_buffer);
    glDisable(GL_LIGHTING);
    measure("1M vertices", million);
    if (glGetError()) printf("an OpenGL error\n");
    OSMesaDestroyContext(context);
    return 0;
}
