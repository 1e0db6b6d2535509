/* gl2ps as a peer of `vitral draw`: a filled drawing of a mesh, one colour a triangle, seen isometrically.
 *
 * cc -O2 gl2ps.c -o gl2ps -lgl2ps -lOSMesa -lm
 * gl2ps MESH.ply OUT.svg simple|bsp [cull]
 *
 * The mesh is binary little-endian PLY as `cargo xtask compare draw` writes it. With `cull` OpenGL drops back faces, which
 * suits closed meshes. Prints one JSON object, as drawing.py does. */
#include <GL/osmesa.h>
#include <GL/gl.h>
#include <gl2ps.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { SIDE = 1000 };

static float *positions;
static int32_t (*triangles)[3];
static int vertex_count, triangle_count;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + t.tv_nsec * 1e-9;
}

static void fail(const char *why) {
    fprintf(stderr, "%s\n", why);
    exit(1);
}

static void read_mesh(const char *path) {
    FILE *file = fopen(path, "rb");
    char line[256];
    if (!file) fail("cannot open the mesh");
    while (fgets(line, sizeof line, file) && strcmp(line, "end_header\n")) {
        sscanf(line, "element vertex %d", &vertex_count);
        sscanf(line, "element face %d", &triangle_count);
    }
    positions = malloc(12 * (size_t)vertex_count);
    triangles = malloc(12 * (size_t)triangle_count);
    if (fread(positions, 12, vertex_count, file) != (size_t)vertex_count) fail("the mesh is too short");
    for (int i = 0; i < triangle_count; i++)
        if (fgetc(file) != 3 || fread(triangles[i], 12, 1, file) != 1) fail("the mesh has no such triangle");
    fclose(file);
}

/* Frames the mesh in parallel projection, seen from (1, 1, 1) with +Y upwards. */
static void set_camera(void) {
    const double axes[3][3] = {{sqrt(.5), 0, -sqrt(.5)}, {-sqrt(1 / 6.), sqrt(2 / 3.), -sqrt(1 / 6.)}, {sqrt(1 / 3.), sqrt(1 / 3.), sqrt(1 / 3.)}};
    double low[3] = {1e30, 1e30, 1e30}, high[3] = {-1e30, -1e30, -1e30}, view[16] = {0};
    for (int i = 0; i < vertex_count; i++)
        for (int k = 0; k < 3; k++) {
            const float *p = positions + 3 * i;
            double at = axes[k][0] * p[0] + axes[k][1] * p[1] + axes[k][2] * p[2];
            low[k] = fmin(low[k], at), high[k] = fmax(high[k], at);
        }
    for (int column = 0; column < 3; column++)
        for (int row = 0; row < 3; row++) view[4 * column + row] = axes[row][column];
    view[15] = 1;
    double half = .51 * fmax(high[0] - low[0], high[1] - low[1]), x = (low[0] + high[0]) / 2, y = (low[1] + high[1]) / 2;
    double thickness = fmax(high[2] - low[2], 1e-6);
    glMatrixMode(GL_PROJECTION);
    glOrtho(x - half, x + half, y - half, y + half, -high[2] - .1 * thickness, -low[2] + .1 * thickness);
    glMatrixMode(GL_MODELVIEW);
    glLoadMatrixd(view);
}

/* Each triangle with its own brightness: that of a light beside the viewer. */
static void draw(void) {
    glBegin(GL_TRIANGLES);
    for (int i = 0; i < triangle_count; i++) {
        const float *a = positions + 3 * triangles[i][0], *b = positions + 3 * triangles[i][1], *c = positions + 3 * triangles[i][2];
        double u[3], v[3], n[3];
        for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k];
        for (int k = 0; k < 3; k++) n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
        double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        double grey = length > 0 ? .2 + .8 * fabs(.4 * n[0] + .8 * n[1] + .45 * n[2]) / length : 0;
        glColor3d(grey, grey, grey);
        glVertex3fv(a), glVertex3fv(b), glVertex3fv(c);
    }
    glEnd();
}

int main(int count, char **arguments) {
    if (count < 4) fail("usage: gl2ps MESH.ply OUT.svg simple|bsp [cull]");
    double start = now();
    read_mesh(arguments[1]);
    unsigned char *pixels = malloc(4 * SIDE * SIDE);
    OSMesaContext context = OSMesaCreateContextExt(OSMESA_RGBA, 24, 0, 0, NULL);
    if (!context || !OSMesaMakeCurrent(context, pixels, GL_UNSIGNED_BYTE, SIDE, SIDE)) fail("OSMesa gives no context");
    set_camera();
    if (count > 4) glEnable(GL_CULL_FACE);
    double loaded = now();

    /* The feedback buffer begins large enough for one vertex record a corner. */
    GLint sort = strcmp(arguments[3], "bsp") ? GL2PS_SIMPLE_SORT : GL2PS_BSP_SORT;
    GLint state = GL2PS_OVERFLOW, size = 64 * triangle_count + 4096;
    while (state == GL2PS_OVERFLOW) {
        FILE *out = fopen(arguments[2], "wb");
        if (!out) fail("cannot write the drawing");
        gl2psBeginPage("mesh", "gl2ps", NULL, GL2PS_SVG, sort, GL2PS_USE_CURRENT_VIEWPORT | GL2PS_SILENT, GL_RGBA, 0, NULL, 0, 0, 0, size, out, arguments[2]);
        draw();
        state = gl2psEndPage();
        fclose(out);
        size *= 2;
    }
    if (state != GL2PS_SUCCESS) fail("gl2ps gives no drawing");
    printf("{\"version\": \"%d.%d.%d\", \"seconds\": {\"load\": %.4f, \"draw\": %.4f}}\n", GL2PS_MAJOR_VERSION, GL2PS_MINOR_VERSION, GL2PS_PATCH_VERSION, loaded - start, now() - loaded);
    return 0;
}
