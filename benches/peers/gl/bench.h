/* What the OpenGL benches share: a context of 640x480 with one sample a pixel, and the median time of a frame, its end
 * (glFinish) included.
 *
 * cc -O2 NAME.c -o NAME $(PKG_CONFIG_PATH=target/osmesa/pkgconfig pkg-config --cflags --libs osmesa) -lm
 * Run it with LD_LIBRARY_PATH at one libOSMesa and at the other. The name of a way as argument measures that alone (`all`
 * measures each); a folder as second argument gets the pictures. */
#define GL_GLEXT_PROTOTYPES
#include <GL/osmesa.h>
#include <GL/gl.h>
#include <GL/glext.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { WIDTH = 640, HEIGHT = 480, FRAMES = 15 };

static const char *only, *folder;
static unsigned char *pixels;
static OSMesaContext context;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * 1e3 + t.tv_nsec * 1e-6;
}

static int by_value(const void *a, const void *b) {
    return (*(const double *)a > *(const double *)b) - (*(const double *)a < *(const double *)b);
}

/* Makes the context, says whose it is, and reads the arguments. */
static void begin(int count, char **arguments) {
    pixels = malloc(WIDTH * HEIGHT * 4);
    context = OSMesaCreateContextExt(OSMESA_RGBA, 24, 8, 16, NULL);
    if (!context || !OSMesaMakeCurrent(context, pixels, GL_UNSIGNED_BYTE, WIDTH, HEIGHT)) exit(1);
    printf("%s\n", (const char *)glGetString(GL_RENDERER));
    if (count > 1 && strcmp(arguments[1], "all")) only = arguments[1];
    if (count > 2) folder = arguments[2];
    glViewport(0, 0, WIDTH, HEIGHT);
}

static int end(void) {
    if (glGetError()) printf("an OpenGL error\n");
    OSMesaDestroyContext(context);
    return 0;
}

static void save(const char *name) {
    char path[1000];
    snprintf(path, sizeof path, "%s/%s.ppm", folder, name);
    FILE *file = fopen(path, "wb");
    if (!file) exit(1);
    fprintf(file, "P6 %d %d 255\n", WIDTH, HEIGHT);
    for (int i = 0; i < WIDTH * HEIGHT; i++) fwrite(pixels + 4 * i, 1, 3, file);
    fclose(file);
}

/* Draws frames, each turned by so many degrees more than the one before, and prints their median time after two to warm up. */
static void measure(const char *name, void (*draw)(void), float turn) {
    double times[FRAMES];
    if (only && strcmp(only, name)) return;
    for (int i = -2; i < FRAMES; i++) {
        double start = now();
        glRotatef(turn, 0, 0, 1);
        glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
        draw();
        glFinish();
        if (i >= 0) times[i] = now() - start;
    }
    qsort(times, FRAMES, sizeof *times, by_value);
    printf("%-14s %8.2f ms\n", name, times[FRAMES / 2]);
    if (folder) save(name);
}
