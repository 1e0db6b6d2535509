/* The kind of program that came with OSMesa: lit, blended and textured shapes into a buffer of bytes, shorts or floats.
 * buffers FOLDER writes FOLDER/bytes.ppm, shorts.ppm and floats.ppm, the first row the highest. */
#include <GL/osmesa.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 320, HEIGHT = 240 };

static void torus(float inner, float outer, int sides, int rings)
{
    const float turn = 6.2831853f;
    for (int i = 0; i < rings; i++) {
        glBegin(GL_QUAD_STRIP);
        for (int j = 0; j <= sides; j++)
            for (int k = 1; k >= 0; k--) {
                float s = turn * (float)((i + k) % rings) / (float)rings, t = turn * (float)(j % sides) / (float)sides;
                float x = outer + inner * cosf(t);
                glNormal3f(cosf(s) * cosf(t), sinf(s) * cosf(t), sinf(t));
                glVertex3f(x * cosf(s), x * sinf(s), inner * sinf(t));
            }
        glEnd();
    }
}

static void draw(void)
{
    const float light[] = { 1, 1, 1, 0 }, red[] = { 1, .2f, .2f, 1 }, green[] = { .2f, 1, .2f, 1 };
    glClearColor(.1f, .1f, .15f, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glEnable(GL_DEPTH_TEST);
    glMatrixMode(GL_PROJECTION);
    glFrustum(-1.0, 1.0, -.75, .75, 2, 20);
    glMatrixMode(GL_MODELVIEW);
    glTranslatef(0, 0, -6);
    glEnable(GL_LIGHTING);
    glEnable(GL_LIGHT0);
    glLightfv(GL_LIGHT0, GL_POSITION, light);
    glMaterialfv(GL_FRONT_AND_BACK, GL_AMBIENT_AND_DIFFUSE, red);
    glPushMatrix();
    glTranslatef(-.8f, .3f, 0);
    glRotatef(50, 1, 0, 0);
    torus(.35f, .9f, 24, 32);
    glPopMatrix();
    glShadeModel(GL_FLAT);
    glMaterialfv(GL_FRONT_AND_BACK, GL_AMBIENT_AND_DIFFUSE, green);
    glPushMatrix();
    glTranslatef(.9f, -.5f, .5f);
    glRotatef(120, 0, 1, .5f);
    torus(.3f, .6f, 12, 16);
    glPopMatrix();
    glDisable(GL_LIGHTING);
    glShadeModel(GL_SMOOTH);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glBegin(GL_QUADS);
    glColor4f(.2f, .4f, 1, .8f), glVertex3f(-1.8f, -1.2f, 1); /* Affine: where the quadrilateral is cut does not matter. */
    glColor4f(.8f, .4f, .5f, .6f), glVertex3f(1.8f, -1.2f, 1);
    glColor4f(.8f, 1, .3f, .2f), glVertex3f(1.8f, .2f, 1);
    glColor4f(.2f, 1, .8f, .4f), glVertex3f(-1.8f, .2f, 1);
    glEnd();
    glFinish();
}

static unsigned char byte_of(const void *buffer, GLenum type, size_t at)
{
    if (type == GL_UNSIGNED_BYTE)
        return ((const unsigned char *)buffer)[at];
    if (type == GL_UNSIGNED_SHORT)
        return ((const unsigned short *)buffer)[at] / 257;
    float value = ((const float *)buffer)[at];
    return (unsigned char)((value < 0 ? 0 : value > 1 ? 1 : value) * 255 + .5f);
}

static int picture(const char *folder, const char *name, GLenum type, size_t size)
{
    char path[4096];
    void *buffer = calloc((size_t)WIDTH * HEIGHT * 4, size);
    OSMesaContext context = OSMesaCreateContextExt(OSMESA_RGBA, 24, 0, 0, NULL);
    if (!buffer || !context || !OSMesaMakeCurrent(context, buffer, type, WIDTH, HEIGHT))
        return fprintf(stderr, "%s: no context\n", name), 1;
    draw();
    snprintf(path, sizeof path, "%s/%s.ppm", folder, name);
    FILE *file = fopen(path, "wb");
    if (!file)
        return perror(path), 1;
    fprintf(file, "P6 %d %d 255\n", WIDTH, HEIGHT);
    for (int y = HEIGHT - 1; y >= 0; y--)
        for (int x = 0; x < WIDTH; x++)
            for (int c = 0; c < 3; c++)
                fputc(byte_of(buffer, type, 4 * ((size_t)y * WIDTH + x) + c), file);
    int failed = fclose(file) | (glGetError() != GL_NO_ERROR);
    OSMesaDestroyContext(context);
    free(buffer);
    return failed;
}

int main(int count, char **words)
{
    const char *folder = count > 1 ? words[1] : ".";
    return picture(folder, "bytes", GL_UNSIGNED_BYTE, 1) | picture(folder, "shorts", GL_UNSIGNED_SHORT, 2)
           | picture(folder, "floats", GL_FLOAT, 4);
}
