/* OpenGL by programs of old: a frame is thousands of small draws, with matrices, materials, textures and switches between
 * them, at once or from lists. bench.h says how to run it. */
#include "bench.h"

enum { ACROSS = 80, DOWN = 60, MANY = ACROSS * DOWN, SIDES = 12 };

static void place(int i) { glTranslatef(i % ACROSS + 0.5f, i / ACROSS + 0.5f, 0); }

static void material(int i) {
    float color[4] = { 0.2f + i % 7 * 0.1f, 0.2f + i % 5 * 0.15f, 0.3f + i % 3 * 0.3f, 1 };
    glMaterialfv(GL_FRONT_AND_BACK, GL_AMBIENT_AND_DIFFUSE, color);
}

static void quad(float x, float y) {
    glBegin(GL_QUADS);
    glNormal3f(0.3f, 0.1f, 0.9f);
    glVertex3f(x - 0.4f, y - 0.4f, 0), glVertex3f(x + 0.4f, y - 0.4f, 0.1f);
    glVertex3f(x + 0.4f, y + 0.4f, 0), glVertex3f(x - 0.4f, y + 0.4f, 0.1f);
    glEnd();
}

/* A tube of strips, as gluCylinder makes it. */
static void tube(void) {
    glBegin(GL_QUAD_STRIP);
    for (int k = 0; k <= SIDES; k++) {
        float a = 6.2831853f * k / SIDES;
        glNormal3f(cosf(a), sinf(a), 0);
        glVertex3f(0.4f * cosf(a), 0.4f * sinf(a), -0.3f);
        glVertex3f(0.4f * cosf(a), 0.4f * sinf(a), 0.3f);
    }
    glEnd();
}

static void pairs(void) {
    for (int i = 0; i < MANY; i++) quad(i % ACROSS + 0.5f, i / ACROSS + 0.5f);
}

static void colors(void) {
    glEnable(GL_COLOR_MATERIAL);
    for (int i = 0; i < MANY; i++) {
        glColor3f(i % 7 * 0.15f, i % 5 * 0.2f, i % 3 * 0.4f);
        quad(i % ACROSS + 0.5f, i / ACROSS + 0.5f);
    }
    glDisable(GL_COLOR_MATERIAL);
}

static void materials(void) {
    for (int i = 0; i < MANY; i++) {
        material(i);
        quad(i % ACROSS + 0.5f, i / ACROSS + 0.5f);
    }
}

static void matrices(void) {
    for (int i = 0; i < MANY; i++) {
        glPushMatrix();
        place(i);
        glRotatef(i, 0, 0, 1);
        quad(0, 0);
        glPopMatrix();
    }
}

static void tubes(void) {
    for (int i = 0; i < MANY / 4; i++) {
        glPushMatrix();
        place(i * 4);
        glRotatef(i, 1, 0, 0);
        material(i);
        tube();
        glPopMatrix();
    }
}

static void strips(void) {
    for (int i = 0; i < DOWN; i++) {
        for (int j = 0; j < 8; j++) {
            glBegin(GL_TRIANGLE_STRIP);
            for (int k = 0; k < 21; k++) {
                float x = (k / 2 + 10 * j), y = i + k % 2;
                glNormal3f(sinf(x) * 0.3f, cosf(y) * 0.3f, 1), glVertex3f(x, y, 0);
            }
            glEnd();
        }
    }
}

static void lists(void) {
    for (int i = 0; i < MANY; i++) {
        glPushMatrix();
        place(i);
        glRotatef(i, 1, 1, 0);
        glCallList(1);
        glPopMatrix();
    }
}

static void listed(void) { glCallList(2); }
static void inside(void) { glCallList(3); }

/* Quads that each have a material, all within one Begin and End. */
static void changing(void) {
    glBegin(GL_QUADS);
    for (int i = 0; i < MANY; i++) {
        float x = i % ACROSS + 0.5f, y = i / ACROSS + 0.5f;
        material(i);
        glNormal3f(0.3f, 0.1f, 0.9f);
        glVertex3f(x - 0.4f, y - 0.4f, 0), glVertex3f(x + 0.4f, y - 0.4f, 0.1f);
        glVertex3f(x + 0.4f, y + 0.4f, 0), glVertex3f(x - 0.4f, y + 0.4f, 0.1f);
    }
    glEnd();
}

static void outlines(void) {
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    tubes();
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

static void loops(void) {
    glDisable(GL_LIGHTING);
    for (int i = 0; i < MANY; i++) {
        float x = i % ACROSS + 0.5f, y = i / ACROSS + 0.5f;
        glColor3f(i % 7 * 0.15f, i % 5 * 0.2f, 1);
        glBegin(GL_LINE_LOOP);
        for (int k = 0; k < 8; k++) glVertex3f(x + 0.4f * cosf(k * 0.7853982f), y + 0.4f * sinf(k * 0.7853982f), 0);
        glEnd();
    }
    glEnable(GL_LIGHTING);
}

static void switches(void) {
    for (int i = 0; i < MANY; i++) {
        (i & 1 ? glEnable : glDisable)(GL_LIGHTING);
        glColor3f(i % 7 * 0.15f, i % 5 * 0.2f, 1);
        quad(i % ACROSS + 0.5f, i / ACROSS + 0.5f);
    }
    glEnable(GL_LIGHTING);
}

static void textures(void) {
    glEnable(GL_TEXTURE_2D);
    for (int i = 0; i < MANY; i++) {
        float x = i % ACROSS, y = i / ACROSS;
        glBindTexture(GL_TEXTURE_2D, 1 + i % 2);
        glBegin(GL_QUADS);
        glNormal3f(0, 0, 1);
        for (int k = 0; k < 4; k++) {
            float s = k == 1 || k == 2, t = k >= 2;
            glTexCoord2f(s, t), glVertex3f(x + 0.8f * s, y + 0.8f * t, 0);
        }
        glEnd();
    }
    glDisable(GL_TEXTURE_2D);
}

static float corners[MANY][4][6];

static void arrays(void) {
    glInterleavedArrays(GL_N3F_V3F, 0, corners);
    for (int i = 0; i < MANY; i++) glDrawArrays(GL_QUADS, 4 * i, 4);
}

int main(int count, char **arguments) {
    float at[4] = { 1, 2, 3, 0 };
    unsigned char image[64 * 64 * 3];
    begin(count, arguments);
    glMatrixMode(GL_PROJECTION);
    glOrtho(0, ACROSS, 0, DOWN, -10, 10);
    glMatrixMode(GL_MODELVIEW);
    glLightfv(GL_LIGHT0, GL_POSITION, at);
    glEnable(GL_LIGHTING), glEnable(GL_LIGHT0), glEnable(GL_DEPTH_TEST);
    for (int t = 1; t <= 2; t++) {
        for (int i = 0; i < 64 * 64 * 3; i++) image[i] = (i / 3 / 8 + i / 192 / 8 * t) % 2 * 128 + i % 3 * 40;
        glBindTexture(GL_TEXTURE_2D, t);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB, 64, 64, 0, GL_RGB, GL_UNSIGNED_BYTE, image);
    }
    for (int i = 0; i < MANY; i++)
        for (int k = 0; k < 4; k++) {
            float *v = corners[i][k];
            v[0] = 0.3f, v[1] = 0.1f, v[2] = 0.9f;
            v[3] = i % ACROSS + 0.1f + 0.8f * (k == 1 || k == 2), v[4] = i / ACROSS + 0.1f + 0.8f * (k >= 2);
        }
    glNewList(1, GL_COMPILE), tube(), glEndList();
    glNewList(2, GL_COMPILE), matrices(), glEndList();
    glNewList(3, GL_COMPILE), changing(), glEndList();
    measure("pairs", pairs, 0);
    measure("colors", colors, 0);
    measure("materials", materials, 0);
    measure("matrices", matrices, 0);
    measure("tubes", tubes, 0);
    measure("strips", strips, 0);
    measure("lists", lists, 0);
    measure("listed", listed, 0);
    measure("inside", inside, 0);
    measure("changing", changing, 0);
    measure("outlines", outlines, 0);
    measure("loops", loops, 0);
    measure("switches", switches, 0);
    measure("textures", textures, 0);
    measure("arrays", arrays, 0);
    return end();
}
