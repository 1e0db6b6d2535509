/* OpenGL's points and lines: clouds of points and nets of lines of several sizes, aliased and smooth, 640x480, one sample a
 * pixel. Prints the median time of a frame, its end (glFinish) included.
 *
 * cc -O2 strokes.c -o strokes -lOSMesa -lm; run it with LD_LIBRARY_PATH at one libOSMesa and at the other.
 * The name of a way as argument measures that alone; a folder as second argument gets the pictures. */
#define GL_GLEXT_PROTOTYPES
#include <GL/osmesa.h>
#include <GL/gl.h>
#include <GL/glext.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { WIDTH = 640, HEIGHT = 480, POINTS = 100000, LINES = 20000, FRAMES = 15 };

static float places[POINTS][7];

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * 1e3 + t.tv_nsec * 1e-6;
}

static int by_value(const void *a, const void *b) {
    return (*(const double *)a > *(const double *)b) - (*(const double *)a < *(const double *)b);
}

static const char *only, *folder;
static unsigned char *pixels;

static void points(float size) {
    glPointSize(size);
    glDrawArrays(GL_POINTS, 0, POINTS);
}
static void points_1(void) { points(1); }
static void points_3(void) { points(3); }
static void points_10(void) { points(10); }
static void smooth_points(void) {
    glEnable(GL_POINT_SMOOTH), glEnable(GL_BLEND);
    points(3);
    glDisable(GL_POINT_SMOOTH), glDisable(GL_BLEND);
}
static void lines(float width) {
    glLineWidth(width);
    glDrawArrays(GL_LINES, 0, 2 * LINES);
}
static void lines_1(void) { lines(1); }
static void lines_3(void) { lines(3); }
static void smooth_lines(void) {
    glEnable(GL_LINE_SMOOTH), glEnable(GL_BLEND);
    lines(1.5f);
    glDisable(GL_LINE_SMOOTH), glDisable(GL_BLEND);
}
static void stippled(void) {
    glEnable(GL_LINE_STIPPLE);
    glLineStipple(2, 0x6d6d);
    lines(1);
    glDisable(GL_LINE_STIPPLE);
}
static void strip(void) {
    glLineWidth(1);
    glDrawArrays(GL_LINE_STRIP, 0, POINTS);
}
static void wires(void) {
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    glDrawArrays(GL_TRIANGLES, 0, 30000);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}
static void corners(void) {
    glPolygonMode(GL_FRONT_AND_BACK, GL_POINT);
    glDrawArrays(GL_TRIANGLES, 0, 90000);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

static void measure(const char *name, void (*draw)(void)) {
    double times[FRAMES];
    if (only && strcmp(only, "all") && strcmp(only, name)) return;
    for (int i = -2; i < FRAMES; i++) {
        double start = now();
        glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
        draw();
        glFinish();
        if (i >= 0) times[i] = now() - start;
    }
    qsort(times, FRAMES, sizeof *times, by_value);
    printf("%-14s %8.2f ms\n", name, times[FRAMES / 2]);
    if (folder) {
        char path[1000];
        snprintf(path, sizeof path, "%s/%s.ppm", folder, name);
        FILE *file = fopen(path, "wb");
        if (!file) exit(1);
        fprintf(file, "P6 %d %d 255\n", WIDTH, HEIGHT);
        for (int i = 0; i < WIDTH * HEIGHT; i++) fwrite(pixels + 4 * i, 1, 3, file);
        fclose(file);
    }
}

int main(int count, char **arguments) {
    unsigned seed = 1;
    pixels = malloc(WIDTH * HEIGHT * 4);
    OSMesaContext context = OSMesaCreateContextExt(OSMESA_RGBA, 24, 8, 0, NULL);
    if (!context || !OSMesaMakeCurrent(context, pixels, GL_UNSIGNED_BYTE, WIDTH, HEIGHT)) return 1;
    printf("%s\n", (const char *)glGetString(GL_RENDERER));
    if (count > 1) only = arguments[1];
    if (count > 2) folder = arguments[2];
    for (int i = 0; i < POINTS; i++) {
        float *v = places[i];
        for (int k = 0; k < 7; k++) {
            seed = seed * 1664525 + 1013904223;
            v[k] = (seed >> 8) / 16777216.0f;
        }
        v[3] = 1;
        for (int k = 4; k < 7; k++) v[k] = 2 * v[k] - 1;
        /* Every second place lies near the one before. */
        if (i % 2) for (int k = 4; k < 7; k++) v[k] = places[i - 1][k] + 0.05f * v[k];
    }
    glMatrixMode(GL_PROJECTION);
    glFrustum(-0.4, 0.4, -0.3, 0.3, 1, 10);
    glMatrixMode(GL_MODELVIEW);
    glTranslatef(0, 0, -4);
    glEnable(GL_DEPTH_TEST);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glVertexPointer(3, GL_FLOAT, sizeof *places, places[0] + 4);
    glColorPointer(4, GL_FLOAT, sizeof *places, places[0]);
    glEnableClientState(GL_VERTEX_ARRAY), glEnableClientState(GL_COLOR_ARRAY);
    measure("points_1", points_1);
    measure("points_3", points_3);
    measure("points_10", points_10);
    measure("smooth_points", smooth_points);
    measure("lines_1", lines_1);
    measure("lines_3", lines_3);
    measure("smooth_lines", smooth_lines);
    measure("stippled", stippled);
    measure("strip", strip);
    measure("wires", wires);
    measure("corners", corners);
    if (glGetError()) printf("an OpenGL error\n");
    OSMesaDestroyContext(context);
    return 0;
}
