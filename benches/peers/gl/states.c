/* OpenGL state by state: what each makes of large quads, of a net of vertices, and of images. bench.h says how to run it. */
#include "bench.h"

enum { NET = 200, SIDE = 256, LAYERS = 6 };

static float net[NET * NET][8];
static unsigned indices[(NET - 1) * (NET - 1) * 4];
static unsigned char image[512 * 512 * 4], words[512 * 512 * 4];
static float floats[512 * 512 * 4];

/* Layers of quads over all of the view, nearer and nearer, with colours and coordinates for all units. */
static void layers(int count) {
    for (int i = 0; i < count; i++) {
        glBegin(GL_QUADS);
        for (int k = 0; k < 4; k++) {
            float s = k == 1 || k == 2, t = k >= 2, z = 0.5f - i * 0.1f;
            glColor4f(s, t, 0.5f, 0.6f);
            for (int unit = 0; unit < 4; unit++) glMultiTexCoord3f(GL_TEXTURE0 + unit, 3 * s + 0.1f * i, 2 * t, s * t);
            glVertex3f(2 * s - 1, 2 * t - 1, z + 0.05f * s);
        }
        glEnd();
    }
}
static void fill(void) { layers(LAYERS); }

static void with(GLenum capability) {
    glEnable(capability);
    fill();
    glDisable(capability);
}
static void depth(void) { with(GL_DEPTH_TEST); }
static void alpha(void) { glAlphaFunc(GL_GREATER, 0.5f), with(GL_ALPHA_TEST); }
static void scissor(void) { glScissor(10, 10, 600, 400), with(GL_SCISSOR_TEST); }
static void stencil(void) {
    glClear(GL_STENCIL_BUFFER_BIT);
    glStencilFunc(GL_ALWAYS, 1, 255), glStencilOp(GL_KEEP, GL_INCR, GL_INCR);
    with(GL_STENCIL_TEST);
}
static void logic(void) { glLogicOp(GL_XOR), with(GL_COLOR_LOGIC_OP); }
static void stipple(void) {
    unsigned char pattern[128];
    for (int i = 0; i < 128; i++) pattern[i] = i / 4 % 2 ? 0x55 : 0xaa;
    glPolygonStipple(pattern), with(GL_POLYGON_STIPPLE);
}
static void mask(void) {
    glColorMask(1, 0, 1, 0);
    fill();
    glColorMask(1, 1, 1, 1);
}
static void flat(void) {
    glShadeModel(GL_FLAT);
    fill();
    glShadeModel(GL_SMOOTH);
}
static void fogged(GLenum mode) {
    glFogi(GL_FOG_MODE, mode), glFogf(GL_FOG_DENSITY, 0.7f), glFogf(GL_FOG_START, -1), glFogf(GL_FOG_END, 1);
    with(GL_FOG);
}
static void fog_linear(void) { fogged(GL_LINEAR); }
static void fog_exp(void) { fogged(GL_EXP); }
static void fog_exp2(void) { fogged(GL_EXP2); }

static void blended(GLenum source, GLenum destination) { glBlendFunc(source, destination), with(GL_BLEND); }
static void blend(void) { blended(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA); }
static void blend_add(void) { blended(GL_ONE, GL_ONE); }
static void blend_multiply(void) { blended(GL_DST_COLOR, GL_ZERO); }
static void blend_saturate(void) { blended(GL_SRC_ALPHA_SATURATE, GL_ONE); }
static void blend_constant(void) {
    glBlendColor(0.2f, 0.4f, 0.6f, 0.8f);
    blended(GL_CONSTANT_COLOR, GL_ONE_MINUS_CONSTANT_COLOR);
}
static void blend_max(void) {
    glBlendEquation(GL_MAX);
    blended(GL_ONE, GL_ONE);
    glBlendEquation(GL_FUNC_ADD);
}

enum { PLAIN = 1, ALPHA, LUMINANCE, SRGB, FLOATS, LINE, VOLUME, CUBE, DEPTHS, FRAME };

static void textured(GLenum target, unsigned name, GLenum least, GLenum most) {
    glBindTexture(target, name);
    glTexParameteri(target, GL_TEXTURE_MIN_FILTER, least), glTexParameteri(target, GL_TEXTURE_MAG_FILTER, most);
    with(target);
}
static void tex_nearest(void) { textured(GL_TEXTURE_2D, PLAIN, GL_NEAREST, GL_NEAREST); }
static void tex_linear(void) { textured(GL_TEXTURE_2D, PLAIN, GL_LINEAR, GL_LINEAR); }
static void tex_near_mip(void) { textured(GL_TEXTURE_2D, PLAIN, GL_NEAREST_MIPMAP_NEAREST, GL_NEAREST); }
static void tex_mip(void) { textured(GL_TEXTURE_2D, PLAIN, GL_LINEAR_MIPMAP_NEAREST, GL_LINEAR); }
static void tex_trilinear(void) { textured(GL_TEXTURE_2D, PLAIN, GL_LINEAR_MIPMAP_LINEAR, GL_LINEAR); }
static void tex_far(void) {
    glMatrixMode(GL_TEXTURE), glLoadIdentity(), glScalef(8, 5, 1);
    tex_trilinear();
    glLoadIdentity(), glMatrixMode(GL_MODELVIEW);
}
static void tex_aniso(void) {
    glMatrixMode(GL_TEXTURE), glLoadIdentity(), glScalef(8, 1, 1);
    glBindTexture(GL_TEXTURE_2D, PLAIN);
    glTexParameterf(GL_TEXTURE_2D, GL_TEXTURE_MAX_ANISOTROPY_EXT, 8);
    tex_trilinear();
    glTexParameterf(GL_TEXTURE_2D, GL_TEXTURE_MAX_ANISOTROPY_EXT, 1);
    glLoadIdentity(), glMatrixMode(GL_MODELVIEW);
}
static void tex_alpha(void) { textured(GL_TEXTURE_2D, ALPHA, GL_LINEAR, GL_LINEAR); }
static void tex_luminance(void) { textured(GL_TEXTURE_2D, LUMINANCE, GL_LINEAR, GL_LINEAR); }
static void tex_srgb(void) { textured(GL_TEXTURE_2D, SRGB, GL_LINEAR, GL_LINEAR); }
static void tex_float(void) { textured(GL_TEXTURE_2D, FLOATS, GL_LINEAR, GL_LINEAR); }
static void tex_1d(void) { textured(GL_TEXTURE_1D, LINE, GL_LINEAR, GL_LINEAR); }
static void tex_3d(void) { textured(GL_TEXTURE_3D, VOLUME, GL_LINEAR, GL_LINEAR); }
static void tex_cube(void) { textured(GL_TEXTURE_CUBE_MAP, CUBE, GL_LINEAR, GL_LINEAR); }
static void tex_shadow(void) { textured(GL_TEXTURE_2D, DEPTHS, GL_NEAREST, GL_NEAREST); }
static void tex_shadow_pcf(void) { textured(GL_TEXTURE_2D, DEPTHS, GL_LINEAR, GL_LINEAR); }
static void wrapped(GLenum wrap) {
    glBindTexture(GL_TEXTURE_2D, PLAIN);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wrap), glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wrap);
    tex_linear();
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT), glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
}
static void tex_edge(void) { wrapped(GL_CLAMP_TO_EDGE); }
static void tex_clamp(void) { wrapped(GL_CLAMP); }
static void tex_border(void) { wrapped(GL_CLAMP_TO_BORDER); }
static void tex_mirror(void) { wrapped(GL_MIRRORED_REPEAT); }
static void environment(GLint mode) {
    glTexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, mode);
    tex_linear();
    glTexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_MODULATE);
}
static void env_replace(void) { environment(GL_REPLACE); }
static void env_decal(void) { environment(GL_DECAL); }
static void env_blend(void) { environment(GL_BLEND); }
static void env_add(void) { environment(GL_ADD); }
static void env_combine(void) {
    glTexEnvi(GL_TEXTURE_ENV, GL_COMBINE_RGB, GL_INTERPOLATE);
    environment(GL_COMBINE);
}
static void env_dot3(void) {
    glTexEnvi(GL_TEXTURE_ENV, GL_COMBINE_RGB, GL_DOT3_RGB);
    environment(GL_COMBINE);
}
static void units(int count) {
    for (int unit = 1; unit < count; unit++) {
        glActiveTexture(GL_TEXTURE0 + unit);
        glBindTexture(GL_TEXTURE_2D, PLAIN), glEnable(GL_TEXTURE_2D);
    }
    glActiveTexture(GL_TEXTURE0);
    tex_linear();
    for (int unit = 1; unit < count; unit++) glActiveTexture(GL_TEXTURE0 + unit), glDisable(GL_TEXTURE_2D);
    glActiveTexture(GL_TEXTURE0);
}
static void units_2(void) { units(2); }
static void units_4(void) { units(4); }
static void tex_blend(void) {
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA), glEnable(GL_BLEND);
    tex_linear();
    glDisable(GL_BLEND);
}
static void generated(GLint mode) {
    glTexGeni(GL_S, GL_TEXTURE_GEN_MODE, mode), glTexGeni(GL_T, GL_TEXTURE_GEN_MODE, mode);
    glEnable(GL_TEXTURE_GEN_S), glEnable(GL_TEXTURE_GEN_T), glEnable(GL_TEXTURE_2D), glBindTexture(GL_TEXTURE_2D, PLAIN);
    glDrawElements(GL_QUADS, sizeof indices / sizeof *indices, GL_UNSIGNED_INT, indices);
    glDisable(GL_TEXTURE_GEN_S), glDisable(GL_TEXTURE_GEN_T), glDisable(GL_TEXTURE_2D);
}
static void gen_object(void) { generated(GL_OBJECT_LINEAR); }
static void gen_eye(void) { generated(GL_EYE_LINEAR); }
static void gen_sphere(void) { generated(GL_SPHERE_MAP); }
static void polygon_smooth(void) {
    glEnable(GL_BLEND), glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA), glEnable(GL_POLYGON_SMOOTH);
    glDrawElements(GL_QUADS, sizeof indices / sizeof *indices, GL_UNSIGNED_INT, indices);
    glDisable(GL_POLYGON_SMOOTH), glDisable(GL_BLEND);
}
static void offset(void) { glPolygonOffset(1, 1), with(GL_POLYGON_OFFSET_FILL); }
static void two_buffers(void) { glDepthFunc(GL_ALWAYS), with(GL_DEPTH_TEST), glDepthFunc(GL_LESS); }

/* A net of vertices, with lights. */
static void drawn(void) { glDrawElements(GL_QUADS, sizeof indices / sizeof *indices, GL_UNSIGNED_INT, indices); }
static void lit(int lights) {
    glEnable(GL_LIGHTING);
    for (int i = 0; i < lights; i++) glEnable(GL_LIGHT0 + i);
    drawn();
    for (int i = 0; i < 8; i++) glDisable(GL_LIGHT0 + i);
    glDisable(GL_LIGHTING);
}
static void net_plain(void) { drawn(); }
static void net_lit(void) { lit(1); }
static void net_lit_8(void) { lit(8); }
static void net_spots(void) {
    for (int i = 0; i < 4; i++) glLightf(GL_LIGHT0 + i, GL_SPOT_CUTOFF, 40), glLightf(GL_LIGHT0 + i, GL_SPOT_EXPONENT, 8);
    lit(4);
    for (int i = 0; i < 4; i++) glLightf(GL_LIGHT0 + i, GL_SPOT_CUTOFF, 180);
}
static void net_two_sided(void) {
    glLightModeli(GL_LIGHT_MODEL_TWO_SIDE, 1);
    lit(1);
    glLightModeli(GL_LIGHT_MODEL_TWO_SIDE, 0);
}
static void net_specular(void) {
    float white[4] = { 1, 1, 1, 1 };
    glMaterialfv(GL_FRONT, GL_SPECULAR, white), glMaterialf(GL_FRONT, GL_SHININESS, 30);
    glLightModeli(GL_LIGHT_MODEL_LOCAL_VIEWER, 1), glLightModeli(GL_LIGHT_MODEL_COLOR_CONTROL, GL_SEPARATE_SPECULAR_COLOR);
    lit(1);
    glLightModeli(GL_LIGHT_MODEL_LOCAL_VIEWER, 0), glLightModeli(GL_LIGHT_MODEL_COLOR_CONTROL, GL_SINGLE_COLOR);
}
static void net_clipped(void) {
    double plane[4] = { 1, 0.5, 0, 0.1 };
    glClipPlane(GL_CLIP_PLANE0, plane);
    glEnable(GL_CLIP_PLANE0);
    drawn();
    glDisable(GL_CLIP_PLANE0);
}
static void net_lines(void) {
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    drawn();
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}
static void net_points(void) {
    glPolygonMode(GL_FRONT_AND_BACK, GL_POINT);
    drawn();
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}
static void evaluated(void) {
    static float points[4][4][3];
    for (int i = 0; i < 16; i++) {
        float *p = points[i / 4][i % 4];
        p[0] = i % 4 * 0.5f - 0.75f, p[1] = i / 4 * 0.5f - 0.75f, p[2] = (i * 7 % 5 - 2) * 0.2f;
    }
    glMap2f(GL_MAP2_VERTEX_3, 0, 1, 3, 4, 0, 1, 12, 4, points[0][0]);
    glEnable(GL_MAP2_VERTEX_3), glEnable(GL_AUTO_NORMAL), glEnable(GL_LIGHTING), glEnable(GL_LIGHT0);
    glMapGrid2f(100, 0, 1, 100, 0, 1), glEvalMesh2(GL_FILL, 0, 100, 0, 100);
    glDisable(GL_MAP2_VERTEX_3), glDisable(GL_AUTO_NORMAL), glDisable(GL_LIGHTING), glDisable(GL_LIGHT0);
}
static void feedback(void) {
    static float buffer[NET * NET * 64];
    glFeedbackBuffer(sizeof buffer / sizeof *buffer, GL_3D_COLOR, buffer);
    glRenderMode(GL_FEEDBACK);
    drawn();
    glRenderMode(GL_RENDER);
}
static void selection(void) {
    static unsigned buffer[1000];
    glSelectBuffer(1000, buffer);
    glRenderMode(GL_SELECT);
    glInitNames(), glPushName(1);
    drawn();
    glRenderMode(GL_RENDER);
}
static void sprites(void) {
    glEnable(GL_POINT_SPRITE), glTexEnvi(GL_POINT_SPRITE, GL_COORD_REPLACE, 1), glPointSize(16);
    glEnable(GL_TEXTURE_2D), glBindTexture(GL_TEXTURE_2D, PLAIN);
    glDrawArrays(GL_POINTS, 0, NET * NET / 4);
    glDisable(GL_POINT_SPRITE), glDisable(GL_TEXTURE_2D), glPointSize(1);
}
static void sprites_small(void) {
    glEnable(GL_POINT_SPRITE), glTexEnvi(GL_POINT_SPRITE, GL_COORD_REPLACE, 1), glPointSize(5);
    glEnable(GL_TEXTURE_2D), glBindTexture(GL_TEXTURE_2D, PLAIN);
    glDrawArrays(GL_POINTS, 0, NET * NET);
    glDisable(GL_POINT_SPRITE), glDisable(GL_TEXTURE_2D), glPointSize(1);
}
static void queried(void) {
    unsigned result;
    glBeginQuery(GL_SAMPLES_PASSED, 1), fill(), glEndQuery(GL_SAMPLES_PASSED);
    glGetQueryObjectuiv(1, GL_QUERY_RESULT, &result);
}

/* Images. */
static void draw_image(GLenum format, GLenum type, const void *from) {
    glRasterPos2f(-1, -1);
    glDrawPixels(512, 460, format, type, from);
}
static void draw_rgba(void) { draw_image(GL_RGBA, GL_UNSIGNED_BYTE, image); }
static void draw_rgb(void) { draw_image(GL_RGB, GL_UNSIGNED_BYTE, image); }
static void draw_bgra(void) { draw_image(GL_BGRA, GL_UNSIGNED_BYTE, image); }
static void draw_luminance(void) { draw_image(GL_LUMINANCE, GL_UNSIGNED_BYTE, image); }
static void draw_565(void) { draw_image(GL_RGB, GL_UNSIGNED_SHORT_5_6_5, words); }
static void draw_float(void) { draw_image(GL_RGBA, GL_FLOAT, floats); }
static void draw_depth(void) {
    glEnable(GL_DEPTH_TEST), draw_image(GL_DEPTH_COMPONENT, GL_FLOAT, floats), glDisable(GL_DEPTH_TEST);
}
static void draw_stencil(void) { draw_image(GL_STENCIL_INDEX, GL_UNSIGNED_BYTE, image); }
static void draw_zoomed(void) {
    glPixelZoom(2, 2), glRasterPos2f(-1, -1);
    glDrawPixels(300, 230, GL_RGBA, GL_UNSIGNED_BYTE, image);
    glPixelZoom(1, 1);
}
static void draw_blended(void) { glEnable(GL_BLEND), draw_rgba(), glDisable(GL_BLEND); }
static void bitmaps(void) {
    glColor3f(1, 1, 1);
    for (int i = 0; i < 3000; i++) {
        glWindowPos2i(i % 60 * 10, i / 60 * 9);
        glBitmap(8, 13, 0, 0, 10, 0, image + i);
    }
}
static void bitmap_large(void) { glWindowPos2i(0, 0), glBitmap(512, 460, 0, 0, 0, 0, image); }
static void copy_pixels(void) { glRasterPos2f(-0.9f, -0.9f), glCopyPixels(0, 0, 500, 400, GL_COLOR); }
static void copy_depth(void) {
    glEnable(GL_DEPTH_TEST), glRasterPos2f(-0.9f, -0.9f), glCopyPixels(0, 0, 500, 400, GL_DEPTH), glDisable(GL_DEPTH_TEST);
}
static void copy_texture(void) {
    glBindTexture(GL_TEXTURE_2D, FRAME), glCopyTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 0, 0, 512, 460);
}
static void accumulate(void) { glAccum(GL_LOAD, 0.5f), glAccum(GL_ACCUM, 0.5f), glAccum(GL_RETURN, 1); }
static void read_rgba(void) { glReadPixels(0, 0, 512, 460, GL_RGBA, GL_UNSIGNED_BYTE, words); }
static void read_depth(void) { glReadPixels(0, 0, 512, 460, GL_DEPTH_COMPONENT, GL_FLOAT, floats + 0); }
static void upload(GLint internal, GLenum format, GLenum type, const void *from) {
    glBindTexture(GL_TEXTURE_2D, FRAME), glTexImage2D(GL_TEXTURE_2D, 0, internal, 512, 512, 0, format, type, from);
}
static void up_rgba(void) { upload(GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, image); }
static void up_rgb(void) { upload(GL_RGB8, GL_RGB, GL_UNSIGNED_BYTE, image); }
static void up_bgra(void) { upload(GL_RGBA8, GL_BGRA, GL_UNSIGNED_BYTE, image); }
static void up_luminance(void) { upload(GL_LUMINANCE8, GL_LUMINANCE, GL_UNSIGNED_BYTE, image); }
static void up_565(void) { upload(GL_RGB5, GL_RGB, GL_UNSIGNED_SHORT_5_6_5, words); }
static void up_float(void) { upload(GL_RGBA32F_ARB, GL_RGBA, GL_FLOAT, floats); }
static void up_small(void) {
    glBindTexture(GL_TEXTURE_2D, PLAIN);
    for (int i = 0; i < 300; i++) glTexSubImage2D(GL_TEXTURE_2D, 0, i % 16 * 16, i / 16 * 13 % 200, 16, 16, GL_RGBA, GL_UNSIGNED_BYTE, image);
}
static void up_drawn(void) {
    for (int i = 0; i < 30; i++) {
        glBindTexture(GL_TEXTURE_2D, PLAIN);
        glTexSubImage2D(GL_TEXTURE_2D, 0, i % 16 * 16, i / 16 * 13 % 200, 16, 16, GL_RGBA, GL_UNSIGNED_BYTE, image);
        glEnable(GL_TEXTURE_2D);
        glRectf(-0.5f, -0.5f, -0.4f, -0.4f);
        glDisable(GL_TEXTURE_2D);
    }
}
static void mipmaps(void) {
    glBindTexture(GL_TEXTURE_2D, PLAIN), glGenerateMipmap(GL_TEXTURE_2D);
}
static void clears(void) { for (int i = 0; i < 10; i++) glClearColor(i * 0.1f, 0, 0, 0), glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT); }
static void clears_scissored(void) {
    glEnable(GL_SCISSOR_TEST);
    for (int i = 0; i < 100; i++) glScissor(i * 5, i * 4, 60, 60), glClearColor(i * 0.01f, 0, 0, 0), glClear(GL_COLOR_BUFFER_BIT);
    glDisable(GL_SCISSOR_TEST), glClearColor(0, 0, 0, 0);
}

#define WAY(name) { #name, name }
static const struct { const char *name; void (*draw)(void); } ways[] = {
    WAY(fill), WAY(flat), WAY(depth), WAY(two_buffers), WAY(offset), WAY(alpha), WAY(scissor), WAY(stencil), WAY(logic), WAY(stipple), WAY(mask),
    WAY(fog_linear), WAY(fog_exp), WAY(fog_exp2), WAY(queried), WAY(blend), WAY(blend_add), WAY(blend_multiply),
    WAY(blend_saturate), WAY(blend_constant), WAY(blend_max), WAY(tex_nearest), WAY(tex_linear), WAY(tex_near_mip), WAY(tex_mip),
    WAY(tex_trilinear), WAY(tex_far), WAY(tex_aniso), WAY(tex_alpha), WAY(tex_luminance), WAY(tex_srgb), WAY(tex_float), WAY(tex_1d), WAY(tex_3d),
    WAY(tex_cube), WAY(tex_shadow), WAY(tex_shadow_pcf), WAY(tex_edge), WAY(tex_clamp), WAY(tex_border), WAY(tex_mirror), WAY(tex_blend), WAY(env_replace), WAY(env_decal),
    WAY(env_blend), WAY(env_add), WAY(env_combine), WAY(env_dot3), WAY(units_2), WAY(units_4), WAY(gen_object), WAY(gen_eye),
    WAY(gen_sphere), WAY(polygon_smooth), WAY(net_plain), WAY(net_lit), WAY(net_lit_8), WAY(net_spots), WAY(net_two_sided), WAY(net_specular),
    WAY(net_clipped), WAY(net_lines), WAY(net_points), WAY(evaluated), WAY(feedback), WAY(selection), WAY(sprites), WAY(sprites_small),
    WAY(draw_rgba), WAY(draw_rgb), WAY(draw_bgra), WAY(draw_luminance), WAY(draw_565), WAY(draw_float), WAY(draw_depth), WAY(draw_stencil),
    WAY(draw_zoomed), WAY(draw_blended), WAY(bitmaps), WAY(bitmap_large), WAY(copy_pixels), WAY(copy_depth), WAY(copy_texture),
    WAY(accumulate), WAY(read_rgba), WAY(read_depth), WAY(up_rgba), WAY(up_rgb), WAY(up_bgra), WAY(up_luminance), WAY(up_565), WAY(up_float),
    WAY(up_small), WAY(up_drawn), WAY(mipmaps), WAY(clears), WAY(clears_scissored),
};

static void make_texture(unsigned name, GLint internal) {
    glBindTexture(GL_TEXTURE_2D, name);
    glTexParameteri(GL_TEXTURE_2D, GL_GENERATE_MIPMAP, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, internal, SIDE, SIDE, 0, GL_RGBA, GL_UNSIGNED_BYTE, image);
    glTexParameteri(GL_TEXTURE_2D, GL_GENERATE_MIPMAP, 0);
}

int main(int count, char **arguments) {
    begin(count, arguments);
    for (int i = 0; i < 512 * 512 * 4; i++) {
        image[i] = (i / 4 / 8 + i / 2048 / 8) % 2 * 128 + i % 4 * 30 + i % 11;
        words[i] = image[i] ^ 85;
        floats[i] = image[i] / 255.0f;
    }
    for (int i = 0; i < NET * NET; i++) {
        float *v = net[i], x = i % NET * 2.0f / (NET - 1) - 1, y = i / NET * 2.0f / (NET - 1) - 1;
        v[0] = (x + 1) / 2, v[1] = (y + 1) / 2;
        v[2] = -cosf(5 * x) * 0.5f, v[3] = sinf(7 * y) * 0.5f, v[4] = 1;
        v[5] = 0.95f * x, v[6] = 0.95f * y, v[7] = 0.1f * sinf(5 * x) + 0.1f * cosf(7 * y);
    }
    unsigned *index = indices;
    for (int i = 0; i < (NET - 1) * (NET - 1); i++) {
        unsigned p = i / (NET - 1) * NET + i % (NET - 1);
        *index++ = p, *index++ = p + 1, *index++ = p + NET + 1, *index++ = p + NET;
    }
    glInterleavedArrays(GL_T2F_N3F_V3F, 0, net);
    for (int i = 0; i < 8; i++) {
        float at[4] = { i - 3.5f, 1, 2, i % 2 }, color[4] = { 0.3f, 0.1f * i, 0.4f, 1 };
        glLightfv(GL_LIGHT0 + i, GL_POSITION, at), glLightfv(GL_LIGHT0 + i, GL_DIFFUSE, color), glLightfv(GL_LIGHT0 + i, GL_SPECULAR, color);
    }
    make_texture(PLAIN, GL_RGBA8), make_texture(ALPHA, GL_ALPHA8), make_texture(LUMINANCE, GL_LUMINANCE8);
    make_texture(SRGB, GL_SRGB8_ALPHA8_EXT), make_texture(FLOATS, GL_RGBA16F_ARB);
    glBindTexture(GL_TEXTURE_1D, LINE), glTexImage1D(GL_TEXTURE_1D, 0, GL_RGBA8, SIDE, 0, GL_RGBA, GL_UNSIGNED_BYTE, image);
    glBindTexture(GL_TEXTURE_3D, VOLUME), glTexImage3D(GL_TEXTURE_3D, 0, GL_RGBA8, 64, 64, 32, 0, GL_RGBA, GL_UNSIGNED_BYTE, image);
    glBindTexture(GL_TEXTURE_CUBE_MAP, CUBE);
    for (int i = 0; i < 6; i++) glTexImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + i, 0, GL_RGBA8, SIDE, SIDE, 0, GL_RGBA, GL_UNSIGNED_BYTE, image + 100 * i);
    glBindTexture(GL_TEXTURE_2D, DEPTHS);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, SIDE, SIDE, 0, GL_DEPTH_COMPONENT, GL_FLOAT, floats);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_R_TO_TEXTURE);
    glBindTexture(GL_TEXTURE_2D, FRAME), glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 512, 512, 0, GL_RGBA, GL_UNSIGNED_BYTE, NULL);
    for (unsigned i = 0; i < sizeof ways / sizeof *ways; i++) measure(ways[i].name, ways[i].draw, 0);
    return end();
}
