/* OpenGL's points and lines: clouds of points and nets of lines of several sizes, aliased and smooth. bench.h says how to
 * run it. */
#include "bench.h"

enum { POINTS = 100000, LINES = 20000 };

static float places[POINTS][7];

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

int main(int count, char **arguments) {
    unsigned seed = 1;
    begin(count, arguments);
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
    measure("points_1", points_1, 0);
    measure("points_3", points_3, 0);
    measure("points_10", points_10, 0);
    measure("smooth_points", smooth_points, 0);
    measure("lines_1", lines_1, 0);
    measure("lines_3", lines_3, 0);
    measure("smooth_lines", smooth_lines, 0);
    measure("stippled", stippled, 0);
    measure("strip", strip, 0);
    measure("wires", wires, 0);
    measure("corners", corners, 0);
    return end();
}
